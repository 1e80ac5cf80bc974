// The clock: what time it is, whether it runs, how finely is drawn.

const begin = Math.min(...scenes.map((s) => columns[s.time][0]));
const end = Math.max(...scenes.map((s) => columns[s.time].at(-1)));
const plots = [];
let now = begin, playing = false, speed = 1, lastFrame = 0, dirty = true, showForces = true;
const frames = { count: 0, since: 0, rate: 0 };

// Resolution of moving pictures, lowered until there are enough of them; still ones are fine.
const quality = {
  parts: [1, 0.8, 0.65, 0.5, 0.4], level: 0, count: 0, since: 0, moved: -Infinity, isFine: false,
  tell(stamp) {
    this.count += 1;
    if (stamp - this.since < 400) return;
    const rate = (1000 * this.count) / (stamp - this.since);
    if (this.since && rate < 36 && this.level + 1 < this.parts.length) this.level += 1;
    this.count = 0;
    this.since = stamp;
  },
  set(fine) {
    const full = Math.min(devicePixelRatio || 1, 2), ratio = fine ? (isSlow ? Math.max(full, 2) : full) : full * this.parts[this.level];
    this.isFine = fine;
    if (renderer && Math.abs(renderer.getPixelRatio() - ratio) > 1e-9) renderer.setPixelRatio(ratio);
  },
};

function seek(t) {
  now = Math.min(end, Math.max(begin, t));
  $("time").value = now;
  dirty = true;
}

function play(wanted) {
  if (wanted && now >= end) seek(begin);
  playing = wanted;
  $("play").setAttribute("aria-label", playing ? "Pause" : "Play");
  frames.count = 0; frames.since = performance.now(); lastFrame = performance.now();
  quality.count = 0; quality.since = 0;
  dirty = true;
}
