"""Run one other engine for peers.py, in the environment the engine is installed in.

Reads requests as lines of JSON from standard input and answers each with a line. What engines
print goes to standard error. Needs NumPy and the engine, nothing of vehicledyn. All times are
processor time, so that other work on the machine counts as little as it can.
"""

from __future__ import annotations

import importlib.metadata
import json
import os
import sys
import time
from xml.etree import ElementTree

import numpy as np

AXES = np.eye(3)


def seconds_a_call(call, calls):
    """Return the mean time of a call [s]."""
    started = time.process_time()
    for _ in range(calls):
        call()
    return (time.process_time() - started) / calls


class Pinocchio:
    """Articulated-body algorithm, pinocchio.aba; one call from Python.

    The call of a model with one joint, which is hardly more than the way from Python to C++ and
    back, is subtracted.
    """

    package = "pin"

    def __init__(self):
        import pinocchio

        self.pin = pinocchio

    def load(self, model):
        self.model = self._build(model["bodies"], model["gravity"])
        self.data = self.model.createData()
        one = self._build(model["bodies"][:1], model["gravity"])
        data, zero = one.createData(), np.zeros(1)
        self._nothing = lambda: self.pin.aba(one, data, zero, zero, zero)

    def _build(self, bodies, gravity):
        pin = self.pin
        model = pin.Model()
        model.gravity.linear = np.array(gravity)
        joints = (pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ)
        for k, body in enumerate(bodies):
            place = pin.SE3(np.array(body["rotation"]), np.array(body["at"]))
            number = model.addJoint(body["parent"] + 1, joints[body["axis"]](), place, f"joint{k}")
            inertia = pin.Inertia(body["mass"], np.array(body["com"]), np.array(body["inertia"]))
            model.appendBodyToJoint(number, inertia, pin.SE3.Identity())
        return model

    def move(self, angles, rates):
        self.q, self.v = np.array(angles), np.array(rates)
        self.tau = np.zeros(len(angles))

    def accelerations(self):
        return self.pin.aba(self.model, self.data, self.q, self.v, self.tau)

    def seconds(self, calls):
        overhead = seconds_a_call(self._nothing, calls)
        return seconds_a_call(self.accelerations, calls) - overhead


class Mujoco:
    """Forward dynamics, mj_forward without contacts; one call from Python.

    A call that only reads one number of the model is subtracted.
    """

    package = "mujoco"

    def __init__(self):
        import mujoco

        self.mujoco = mujoco

    def load(self, model):
        root = ElementTree.Element("mujoco")
        ElementTree.SubElement(root, "compiler", angle="radian", inertiafromgeom="false")
        option = ElementTree.SubElement(root, "option", gravity=_text(model["gravity"]))
        ElementTree.SubElement(option, "flag", contact="disable", constraint="disable")
        elements = [ElementTree.SubElement(root, "worldbody")]
        for k, body in enumerate(model["bodies"]):
            quaternion = np.zeros(4)
            self.mujoco.mju_mat2Quat(quaternion, np.array(body["rotation"]).ravel())
            parent = elements[body["parent"] + 1]
            element = ElementTree.SubElement(
                parent, "body", pos=_text(body["at"]), quat=_text(quaternion)
            )
            ElementTree.SubElement(
                element, "joint", type="hinge", axis=_text(AXES[body["axis"]]), name=f"joint{k}"
            )
            i = np.array(body["inertia"])
            full = [i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]]
            ElementTree.SubElement(
                element,
                "inertial",
                pos=_text(body["com"]),
                mass=repr(body["mass"]),
                fullinertia=_text(full),
            )
            elements.append(element)
        self.model = self.mujoco.MjModel.from_xml_string(ElementTree.tostring(root, "unicode"))
        self.data = self.mujoco.MjData(self.model)
        names = [f"joint{k}" for k in range(len(model["bodies"]))]
        self.order = [self.model.joint(name).dofadr[0] for name in names]

    def move(self, angles, rates):
        self.data.qpos[self.order], self.data.qvel[self.order] = angles, rates

    def accelerations(self):
        self._forward()
        return self.data.qacc[self.order]

    def _forward(self):
        self.mujoco.mj_forward(self.model, self.data)

    def seconds(self, calls):
        overhead = seconds_a_call(lambda: self.mujoco.mj_getTotalmass(self.model), calls)
        return seconds_a_call(self._forward, calls) - overhead


class Exudyn:
    """Kinematic tree; explicit Euler steps inside its solver.

    The time of a step is the difference of a long and a short run over the steps between.
    """

    package = "exudyn"

    def __init__(self):
        import exudyn

        self.exu = exudyn

    def load(self, model):
        self.bodies, self.gravity = model["bodies"], model["gravity"]

    def move(self, angles, rates):
        from exudyn.itemInterface import NodeGenericODE2, ObjectKinematicTree

        exu, bodies = self.exu, self.bodies
        self.system = exu.SystemContainer()
        self.mbs = self.system.AddSystem()
        node = self.mbs.AddNode(
            NodeGenericODE2(
                referenceCoordinates=[0.0] * len(bodies),
                initialCoordinates=list(angles),
                initialCoordinates_t=list(rates),
                numberOfODE2Coordinates=len(bodies),
            )
        )
        kinds = (exu.JointType.RevoluteX, exu.JointType.RevoluteY, exu.JointType.RevoluteZ)
        self.mbs.AddObject(
            ObjectKinematicTree(
                nodeNumber=node,
                gravity=self.gravity,
                jointTypes=[kinds[body["axis"]] for body in bodies],
                linkParents=[body["parent"] for body in bodies],
                jointTransformations=exu.Matrix3DList(
                    [np.array(body["rotation"]) for body in bodies]
                ),
                jointOffsets=exu.Vector3DList([body["at"] for body in bodies]),
                linkInertiasCOM=exu.Matrix3DList([np.array(body["inertia"]) for body in bodies]),
                linkCOMs=exu.Vector3DList([body["com"] for body in bodies]),
                linkMasses=[body["mass"] for body in bodies],
            )
        )
        self.mbs.Assemble()

    def accelerations(self):
        self._run(1, 1e-12)
        return self.mbs.systemData.GetODE2Coordinates_tt()

    def _run(self, steps, step):
        settings = _exudyn_settings(self.exu, steps, step)
        kinds = self.exu.DynamicSolverType
        started = time.process_time()
        self.mbs.SolveDynamic(settings, solverType=kinds.ExplicitEuler, showHints=False)
        return time.process_time() - started

    def seconds(self, calls):
        calls, short = max(1, calls // 5), max(10, calls // 50)
        return (self._run(calls + short, 1e-9) - self._run(short, 1e-9)) / calls

    def four_bars(self, count, step, duration, interval):
        """Return the times of a run of the four-bar chain [s] and t, x, y of B0 at the samples.

        Generalised-alpha with modified Newton iterations and sparse factorisations, which is the
        fastest of the solver's settings here.
        """
        from exudyn.itemInterface import (
            Force,
            MarkerBodyPosition,
            NodeRigidBody2D,
            ObjectGround,
            ObjectJointRevolute2D,
            ObjectRigidBody2D,
            SensorBody,
        )

        exu = self.exu
        system = exu.SystemContainer()
        mbs = system.AddSystem()
        ground = mbs.AddObject(ObjectGround())

        def bar(place, angle, velocity, rate):
            node = mbs.AddNode(
                NodeRigidBody2D(
                    referenceCoordinates=[*place, angle], initialVelocities=[*velocity, rate]
                )
            )
            body = mbs.AddObject(
                ObjectRigidBody2D(physicsMass=1.0, physicsInertia=1.0 / 12.0, nodeNumber=node)
            )
            centre = mbs.AddMarker(MarkerBodyPosition(bodyNumber=body))
            mbs.AddLoad(Force(markerNumber=centre, loadVector=[0.0, -9.81, 0.0]))
            return body

        def join(first, at, second, there):
            markers = [
                mbs.AddMarker(MarkerBodyPosition(bodyNumber=body, localPosition=[x, y, 0.0]))
                for body, (x, y) in ((first, at), (second, there))
            ]
            mbs.AddObject(ObjectJointRevolute2D(markerNumbers=markers))

        low, high = (-0.5, 0.0), (0.5, 0.0)
        uprights = [bar((k, 0.5), 0.5 * np.pi, (0.5, 0.0), -1.0) for k in range(count + 1)]
        for k, upright in enumerate(uprights):
            join(ground, (k, 0.0), upright, low)
        for k in range(count):
            coupler = bar((k + 0.5, 1.0), 0.0, (1.0, 0.0), 0.0)
            join(uprights[k], high, coupler, low)
            join(coupler, high, uprights[k + 1], high)
        sensor = mbs.AddSensor(
            SensorBody(
                bodyNumber=uprights[0],
                localPosition=[0.5, 0.0, 0.0],
                storeInternal=True,
                outputVariableType=exu.OutputVariableType.Position,
            )
        )
        mbs.Assemble()
        settings = _exudyn_settings(exu, round(duration / step), step)
        settings.solutionSettings.sensorsWritePeriod = interval
        integration = settings.timeIntegration
        integration.generalizedAlpha.spectralRadius = 0.9
        integration.newton.useModifiedNewton = True
        settings.linearSolverType = exu.LinearSolverType.EigenSparse
        started, wall = time.process_time(), time.perf_counter()
        mbs.SolveDynamic(settings, showHints=False)
        seconds, wall = time.process_time() - started, time.perf_counter() - wall
        return {
            "seconds": seconds,
            "wall": wall,
            "samples": mbs.GetSensorStoredData(sensor)[:, :3].tolist(),
        }


def _exudyn_settings(exu, steps, step):
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = steps
    settings.timeIntegration.endTime = steps * step
    settings.timeIntegration.verboseMode = 0
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWritePeriod = 1e9
    settings.parallel.numberOfThreads = 1
    return settings


def _text(values):
    return " ".join(repr(float(value)) for value in values)


ENGINES = {"pinocchio": Pinocchio, "MuJoCo": Mujoco, "EXUDYN": Exudyn}


def main():
    """Answer requests until the input ends."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    kind = ENGINES[sys.argv[1]]
    try:
        engine = kind()
    except ImportError as error:
        hello = {"missing": str(error)}
    else:
        hello = {"version": importlib.metadata.version(kind.package)}
    answers.write(json.dumps(hello) + "\n")
    answers.flush()
    for line in sys.stdin:
        name, arguments = json.loads(line)
        found = getattr(engine, name)(*arguments)
        found = found.tolist() if isinstance(found, np.ndarray) else found
        answers.write(json.dumps(found) + "\n")
        answers.flush()


if __name__ == "__main__":
    main()
