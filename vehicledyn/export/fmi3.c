/* FMI 3.0, model exchange, around a kernel. Before this stand the kernel's own functions and
   the tables that the exporter writes: NP, NC, TOKEN, start values, terminal events and resets.
   Value references: time, states, their derivatives, parameters, channels, event indicators. */

#include <stdlib.h>

#ifdef FMI3_HEADERS
#include "fmi3Functions.h"
#else
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef void *fmi3Instance, *fmi3InstanceEnvironment, *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8, fmi3Byte;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean, fmi3Clock;
typedef const char *fmi3String;
typedef const fmi3Byte *fmi3Binary;
typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum {
  fmi3Independent, fmi3Constant, fmi3Fixed, fmi3Tunable, fmi3Discrete, fmi3Dependent
} fmi3DependencyKind;
typedef enum {
  fmi3IntervalNotYetKnown, fmi3IntervalUnchanged, fmi3IntervalChanged
} fmi3IntervalQualifier;
typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String,
                                       fmi3String);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment, fmi3Float64, fmi3Boolean,
                                               fmi3Boolean, fmi3Boolean, fmi3Boolean,
                                               fmi3Boolean *, fmi3Float64 *);
typedef void (*fmi3LockPreemptionCallback)();
typedef void (*fmi3UnlockPreemptionCallback)();
#endif

#define UNUSED(a) (void)(a)

enum { TIME = 0, STATE = 1, RATE = STATE + NX, PARAMETER = RATE + NX, CHANNEL = PARAMETER + NP,
       INDICATOR = CHANNEL + NY, END = INDICATOR + NE };

typedef struct {
  fmi3InstanceEnvironment environment;
  fmi3LogMessageCallback log;
  double t, x[NX1], z[NZ1], accepted[NZ1], p[NP + NT + 1], c[NC + NT + 1], rate[NX1], y[NY + 1], mark[NE1];
  int sides[NE1];
  bool initialising, has_constants, has_unknowns, has_rates, has_outputs, has_marks;
} Model;

static fmi3Status tell(const Model *m, fmi3Status status, const char *text) {
  if (m->log) m->log(m->environment, status, "logStatusError", text);
  return status;
}

static void restart(Model *m) {
  m->t = 0.0;
  memcpy(m->x, state_start, NX * sizeof(double));
  memcpy(m->z, unknown_start, NZ * sizeof(double));
  memcpy(m->accepted, m->z, NZ * sizeof(double));
  memcpy(m->p, parameter_start, NP * sizeof(double));
  fill_table_rows(m->p + NP);
  fill_table_rows(m->c + NC);
  memset(m->sides, 0, sizeof m->sides);
  m->initialising = true;
  m->has_constants = m->has_unknowns = false;
}

/* Find the unknowns of the present point, from those of the last one. */
static fmi3Status solve(Model *m) {
  struct course course;
  if (!m->has_constants) {
    prepare(m->p, m->c);
    m->has_constants = true;
    m->has_unknowns = false;
  }
  if (m->has_unknowns) return fmi3OK;
  m->has_rates = m->has_outputs = m->has_marks = false;
  begin_course(&course);
  check_finite(m->x, &course);
  if (!course.alive)
    return tell(m, m->initialising ? fmi3Error : fmi3Discard, "a state is no finite number");
  solve_blocks(m->t, m->x, m->z, m->c, &course);
  if (!course.alive) {
    memcpy(m->z, m->accepted, NZ * sizeof(double));
    return tell(m, m->initialising ? fmi3Error : fmi3Discard, block_failures[course.where[0]]);
  }
  m->has_unknowns = true;
  return fmi3OK;
}

static fmi3Status find_rates(Model *m) {
  const fmi3Status status = solve(m);
  if (status == fmi3OK && !m->has_rates) {
    rates(&m->t, m->x, m->z, m->c, m->rate);
    m->has_rates = true;
  }
  return status;
}

static fmi3Status find_outputs(Model *m) {
  const fmi3Status status = solve(m);
  if (status == fmi3OK && !m->has_outputs) {
    outputs(&m->t, m->x, m->z, m->c, m->y);
    m->has_outputs = true;
  }
  return status;
}

static fmi3Status find_marks(Model *m) {
  const fmi3Status status = solve(m);
  if (status == fmi3OK && !m->has_marks) {
    events(&m->t, m->x, m->z, m->c, m->mark);
    m->has_marks = true;
  }
  return status;
}

/* Let the events that fire happen; return whether a state changed. */
static bool happen(Model *m, fmi3Boolean *terminate) {
  double value[NR + 1];
  bool fired[NE1] = {false}, changed = false;
  for (int k = 0; k < NE; k++)
    fired[k] = (m->sides[k] < 0 && m->mark[k] >= 0.0 && fires_rising[k]) ||
               (m->sides[k] > 0 && m->mark[k] <= 0.0 && fires_falling[k]);
  resets(&m->t, m->x, m->z, m->c, value);
  for (int k = 0; k < NE; k++)
    if (fired[k]) {
      m->sides[k] = 0;
      if (is_terminal[k]) *terminate = true;
      for (int i = reset_start[k]; i < reset_start[k + 1]; i++) {
        m->x[reset_state[i]] = value[reset_row[i]];
        changed = true;
      }
    }
  if (changed) m->has_unknowns = false;
  return changed;
}

static void note_sides(Model *m) {
  for (int k = 0; k < NE; k++)
    if (m->mark[k] != 0.0) m->sides[k] = m->mark[k] > 0.0 ? 1 : -1;
}

VD_EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

VD_EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t n,
                                         const fmi3String categories[]) {
  UNUSED(instance), UNUSED(on), UNUSED(n), UNUSED(categories);
  return fmi3OK;
}

VD_EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token,
                                                    fmi3String resources, fmi3Boolean visible,
                                                    fmi3Boolean logging,
                                                    fmi3InstanceEnvironment environment,
                                                    fmi3LogMessageCallback log) {
  UNUSED(name), UNUSED(resources), UNUSED(visible), UNUSED(logging);
  if (!token || strcmp(token, TOKEN) != 0) {
    if (log) log(environment, fmi3Error, "logStatusError", "the token is that of another model");
    return NULL;
  }
  Model *m = calloc(1, sizeof(Model));
  if (!m) return NULL;
  m->environment = environment;
  m->log = log;
  restart(m);
  return m;
}

VD_EXPORT fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3Boolean events_used, fmi3Boolean early,
    const fmi3ValueReference required[], size_t n, fmi3InstanceEnvironment environment,
    fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update) {
  UNUSED(name), UNUSED(token), UNUSED(resources), UNUSED(visible), UNUSED(logging);
  UNUSED(events_used), UNUSED(early), UNUSED(required), UNUSED(n), UNUSED(update);
  if (log) log(environment, fmi3Error, "logStatusError", "this is a model-exchange FMU");
  return NULL;
}

VD_EXPORT fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
    fmi3UnlockPreemptionCallback unlock) {
  UNUSED(name), UNUSED(token), UNUSED(resources), UNUSED(visible), UNUSED(logging);
  UNUSED(update), UNUSED(lock), UNUSED(unlock);
  if (log) log(environment, fmi3Error, "logStatusError", "this is a model-exchange FMU");
  return NULL;
}

VD_EXPORT void fmi3FreeInstance(fmi3Instance instance) { free(instance); }

VD_EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean given,
                                                 fmi3Float64 tolerance, fmi3Float64 start,
                                                 fmi3Boolean ends, fmi3Float64 stop) {
  Model *m = instance;
  UNUSED(given), UNUSED(tolerance), UNUSED(ends), UNUSED(stop);
  m->t = start;
  m->has_unknowns = false;
  return fmi3OK;
}

VD_EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
  Model *m = instance;
  const fmi3Status status = find_marks(m);
  if (status != fmi3OK) return status;
  memcpy(m->accepted, m->z, NZ * sizeof(double));
  note_sides(m);
  m->initialising = false;
  return fmi3OK;
}

VD_EXPORT fmi3Status fmi3EnterEventMode(fmi3Instance instance) {
  UNUSED(instance);
  return fmi3OK;
}

VD_EXPORT fmi3Status fmi3Terminate(fmi3Instance instance) {
  UNUSED(instance);
  return fmi3OK;
}

VD_EXPORT fmi3Status fmi3Reset(fmi3Instance instance) {
  restart(instance);
  return fmi3OK;
}

VD_EXPORT fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference wanted[],
                                    size_t n, fmi3Float64 values[], size_t n_values) {
  Model *m = instance;
  if (n_values != n) return tell(m, fmi3Error, "all variables are scalars");
  for (size_t k = 0; k < n; k++) {
    const fmi3ValueReference v = wanted[k];
    fmi3Status status = fmi3OK;
    if (v == TIME) {
      values[k] = m->t;
    } else if (v < RATE) {
      values[k] = m->x[v - STATE];
    } else if (v < PARAMETER) {
      status = find_rates(m);
      values[k] = m->rate[v - RATE];
    } else if (v < CHANNEL) {
      values[k] = m->p[v - PARAMETER];
    } else if (v < INDICATOR) {
      status = find_outputs(m);
      values[k] = m->y[v - CHANNEL];
    } else if (v < END) {
      status = find_marks(m);
      values[k] = m->mark[v - INDICATOR];
    } else {
      return tell(m, fmi3Error, "there is no variable of this value reference");
    }
    if (status != fmi3OK) return status;
  }
  return fmi3OK;
}

VD_EXPORT fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference given[],
                                    size_t n, const fmi3Float64 values[], size_t n_values) {
  Model *m = instance;
  if (n_values != n) return tell(m, fmi3Error, "all variables are scalars");
  for (size_t k = 0; k < n; k++) {
    const fmi3ValueReference v = given[k];
    if (v >= PARAMETER && v < CHANNEL) {
      m->p[v - PARAMETER] = values[k];
      m->has_constants = false;
    } else if (v >= STATE && v < RATE && m->initialising) {
      m->x[v - STATE] = values[k];
      m->has_unknowns = false;
    } else {
      return tell(m, fmi3Error, "this variable cannot be set, or not now");
    }
  }
  return fmi3OK;
}

#define NO_VARIABLES(TYPE)                                                                      \
  VD_EXPORT fmi3Status fmi3Get##TYPE(fmi3Instance instance, const fmi3ValueReference v[],       \
                                     size_t n, fmi3##TYPE values[], size_t n_values) {          \
    UNUSED(v), UNUSED(values), UNUSED(n_values);                                                \
    return n ? tell(instance, fmi3Error, "there are no variables of this type") : fmi3OK;       \
  }                                                                                             \
  VD_EXPORT fmi3Status fmi3Set##TYPE(fmi3Instance instance, const fmi3ValueReference v[],       \
                                     size_t n, const fmi3##TYPE values[], size_t n_values) {    \
    UNUSED(v), UNUSED(values), UNUSED(n_values);                                                \
    return n ? tell(instance, fmi3Error, "there are no variables of this type") : fmi3OK;       \
  }

NO_VARIABLES(Float32)
NO_VARIABLES(Int8)
NO_VARIABLES(UInt8)
NO_VARIABLES(Int16)
NO_VARIABLES(UInt16)
NO_VARIABLES(Int32)
NO_VARIABLES(UInt32)
NO_VARIABLES(Int64)
NO_VARIABLES(UInt64)
NO_VARIABLES(Boolean)
NO_VARIABLES(String)

/* The functions below belong to features that the model description does not offer. */
#define NOT_OFFERED(NAME, ...)                                                            \
  VD_EXPORT fmi3Status NAME(fmi3Instance instance, __VA_ARGS__) {                         \
    return tell(instance, fmi3Error, #NAME " is not offered by this FMU");                \
  }
#define REFERENCES const fmi3ValueReference v[], size_t n

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

NOT_OFFERED(fmi3GetBinary, REFERENCES, size_t sizes[], fmi3Binary values[], size_t m)
NOT_OFFERED(fmi3SetBinary, REFERENCES, const size_t sizes[], const fmi3Binary values[], size_t m)
NOT_OFFERED(fmi3GetClock, REFERENCES, fmi3Clock values[])
NOT_OFFERED(fmi3SetClock, REFERENCES, const fmi3Clock values[])
NOT_OFFERED(fmi3GetNumberOfVariableDependencies, fmi3ValueReference v, size_t *n)
NOT_OFFERED(fmi3GetVariableDependencies, fmi3ValueReference v, size_t a[],
            fmi3ValueReference independents[], size_t b[], fmi3DependencyKind kinds[], size_t n)
NOT_OFFERED(fmi3SerializedFMUStateSize, fmi3FMUState state, size_t *size)
NOT_OFFERED(fmi3SerializeFMUState, fmi3FMUState state, fmi3Byte bytes[], size_t size)
NOT_OFFERED(fmi3DeserializeFMUState, const fmi3Byte bytes[], size_t size, fmi3FMUState *state)
NOT_OFFERED(fmi3GetDirectionalDerivative, REFERENCES, const fmi3ValueReference knowns[],
            size_t n_knowns, const fmi3Float64 seed[], size_t n_seed, fmi3Float64 values[],
            size_t n_values)
NOT_OFFERED(fmi3GetAdjointDerivative, REFERENCES, const fmi3ValueReference knowns[],
            size_t n_knowns, const fmi3Float64 seed[], size_t n_seed, fmi3Float64 values[],
            size_t n_values)
NOT_OFFERED(fmi3GetIntervalDecimal, REFERENCES, fmi3Float64 intervals[],
            fmi3IntervalQualifier qualifiers[])
NOT_OFFERED(fmi3GetIntervalFraction, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
            fmi3IntervalQualifier qualifiers[])
NOT_OFFERED(fmi3GetShiftDecimal, REFERENCES, fmi3Float64 shifts[])
NOT_OFFERED(fmi3GetShiftFraction, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
NOT_OFFERED(fmi3SetIntervalDecimal, REFERENCES, const fmi3Float64 intervals[])
NOT_OFFERED(fmi3SetIntervalFraction, REFERENCES, const fmi3UInt64 counters[],
            const fmi3UInt64 resolutions[])
NOT_OFFERED(fmi3SetShiftDecimal, REFERENCES, const fmi3Float64 shifts[])
NOT_OFFERED(fmi3SetShiftFraction, REFERENCES, const fmi3UInt64 counters[],
            const fmi3UInt64 resolutions[])
NOT_OFFERED(fmi3GetOutputDerivatives, REFERENCES, const fmi3Int32 orders[], fmi3Float64 values[],
            size_t n_values)
NOT_OFFERED(fmi3DoStep, fmi3Float64 point, fmi3Float64 size, fmi3Boolean no_return,
            fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last)
NOT_OFFERED(fmi3ActivateModelPartition, fmi3ValueReference clock, fmi3Float64 time)

VD_EXPORT fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance) {
  return tell(instance, fmi3Error, "there are no structural parameters");
}

VD_EXPORT fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance) {
  return tell(instance, fmi3Error, "there are no structural parameters");
}

VD_EXPORT fmi3Status fmi3EnterStepMode(fmi3Instance instance) {
  return tell(instance, fmi3Error, "this is a model-exchange FMU");
}

VD_EXPORT fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance) { return fmi3OK; }

VD_EXPORT fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state) {
  if (!*state) *state = malloc(sizeof(Model));
  if (!*state) return tell(instance, fmi3Error, "out of memory");
  memcpy(*state, instance, sizeof(Model));
  return fmi3OK;
}

VD_EXPORT fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
  memcpy(instance, state, sizeof(Model));
  return fmi3OK;
}

VD_EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state) {
  free(*state);
  *state = NULL;
  return fmi3OK;
}

VD_EXPORT fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *again,
                                              fmi3Boolean *terminate, fmi3Boolean *nominals,
                                              fmi3Boolean *values, fmi3Boolean *has_next,
                                              fmi3Float64 *next) {
  Model *m = instance;
  *again = *terminate = *nominals = *values = *has_next = false;
  fmi3Status status = find_marks(m);
  if (status != fmi3OK) return status;
  *values = happen(m, terminate);
  if ((status = find_marks(m)) != fmi3OK) return status;
  memcpy(m->accepted, m->z, NZ * sizeof(double));
  note_sides(m);
  return fmi3OK;
}

VD_EXPORT fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance) { return fmi3OK; }

VD_EXPORT fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean no_return,
                                                 fmi3Boolean *event, fmi3Boolean *terminate) {
  Model *m = instance;
  const fmi3Status status = solve(m);
  *event = *terminate = false;
  if (status != fmi3OK) return status;
  memcpy(m->accepted, m->z, NZ * sizeof(double));
  *event = NE && event_fires(m->t, m->x, m->z, m->c, m->sides);
  return fmi3OK;
}

VD_EXPORT fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time) {
  Model *m = instance;
  if (time != m->t) m->has_unknowns = false;
  m->t = time;
  return fmi3OK;
}

VD_EXPORT fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 states[],
                                             size_t n) {
  Model *m = instance;
  if (n != NX) return tell(m, fmi3Error, "the number of states is another one");
  memcpy(m->x, states, NX * sizeof(double));
  m->has_unknowns = false;
  return fmi3OK;
}

VD_EXPORT fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance,
                                                       fmi3Float64 derivatives[], size_t n) {
  Model *m = instance;
  if (n != NX) return tell(m, fmi3Error, "the number of states is another one");
  const fmi3Status status = find_rates(m);
  if (status == fmi3OK) memcpy(derivatives, m->rate, NX * sizeof(double));
  return status;
}

VD_EXPORT fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 values[],
                                            size_t n) {
  Model *m = instance;
  if (n != NE) return tell(m, fmi3Error, "the number of event indicators is another one");
  const fmi3Status status = find_marks(m);
  if (status == fmi3OK) memcpy(values, m->mark, NE * sizeof(double));
  return status;
}

VD_EXPORT fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 states[],
                                             size_t n) {
  Model *m = instance;
  if (n != NX) return tell(m, fmi3Error, "the number of states is another one");
  memcpy(states, m->x, NX * sizeof(double));
  return fmi3OK;
}

VD_EXPORT fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance instance,
                                                       fmi3Float64 nominals[], size_t n) {
  for (size_t k = 0; k < n; k++) nominals[k] = 1.0;
  return fmi3OK;
}

VD_EXPORT fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t *n) {
  *n = NE;
  return fmi3OK;
}

VD_EXPORT fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t *n) {
  *n = NX;
  return fmi3OK;
}
