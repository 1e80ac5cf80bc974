// The start: renderer, views, keys and buttons, the first picture.

const first = scenes[0];
$("title").textContent = first.title;
$("about").textContent = [first.model, first.created.slice(0, 10)].filter(Boolean).join(" · ");
const warnings = scenes.flatMap((s, i) => {
  const who = scenes.length > 1 ? `Result ${i + 1}: ` : "";
  return [s.whole ? null : who + s.state, s.bad === null ? null : `${who}values from t = ${shown(s.bad)} s on are not numbers; what is unknown is left out`].filter(Boolean);
});
$("warning").hidden = !warnings.length;
$("warning").textContent = warnings.join("; ");
$("time").min = begin; $("time").max = end > begin ? end : begin + 1; $("time").value = begin;
if (scenes.length > 1) {
  $("key").hidden = false;
  scenes.forEach((s, i) => {
    const item = element($("key"), "li"), swatch = element(item, "i");
    swatch.style.background = i ? TINTS[i % TINTS.length] : "#5a6875";
    item.append(`${s.label}: ${s.title}`);
  });
  $("other-choice").hidden = false;
}

if (first.levels) {
  $("levels").hidden = false;
  $("levels").firstElementChild.textContent = first.levels.text;
}

// Smooth edges cost a processor that draws in place of a graphics card its speed; there a still
// picture is drawn finer instead.
const isSlow = drawsOnProcessor();
let renderer = null;
try {
  renderer = new THREE.WebGLRenderer({ canvas: $("picture"), antialias: !isSlow });
} catch {
  $("warning").hidden = false;
  $("warning").textContent = "This browser draws no 3-D pictures (WebGL is off or absent); the plots work without.";
}
const view = new THREE.Scene();
const actors = scenes.map((scene, i) => new Actor(scene, i));
const extent = actors[0].extent;
const surroundings = new Surroundings(actors[0]);
view.add(surroundings.group, ...actors.map((actor) => actor.group));
view.add(new THREE.HemisphereLight(0xffffff, 0x8a949c, 2.1));
const sun = new THREE.DirectionalLight(0xffffff, 1.9);
sun.position.set(-3, -5, 8);
view.add(sun);
const camera = new THREE.PerspectiveCamera(38, 1, 0.01 * extent, 400 * extent);
camera.up.copy(UP);
const controls = new THREE.OrbitControls(camera, $("picture"));
controls.maxDistance = 60 * extent;
controls.minDistance = 0.15 * extent;
controls.maxPolarAngle = 0.53 * Math.PI;
controls.addEventListener("change", () => { dirty = true; });
controls.addEventListener("start", () => { quality.moved = Infinity; });
controls.addEventListener("end", () => { quality.moved = performance.now(); });
let mode = "follow", target = actors[0].now.clone().add(actors[0].middle), heading = actors[0].heading();
const startHeading = heading;

const VIEWS = { angle: [-1.25, -1.36, 0.78], side: [0, -1.9, 0.25], front: [1.9, 0, 0.35], top: [-0.001, 0, 2.1] };
function look(name) {
  const ahead = new THREE.Vector3(...VIEWS[name]).normalize(), back = ahead.clone().applyAxisAngle(UP, startHeading);
  const right = new THREE.Vector3().crossVectors(UP, back).normalize();
  const up = new THREE.Vector3().crossVectors(back, right), half = actors[0].half;
  // As near as the box around the vehicle allows, with some room.
  const tall = Math.tan((0.5 * camera.fov * Math.PI) / 180), wide = tall * camera.aspect;
  let distance = 0.6 * extent;
  for (let k = 0; k < 8; k++) {
    const corner = new THREE.Vector3(k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z);
    const near = corner.dot(back);
    distance = Math.max(distance, near + (1.15 * Math.abs(corner.dot(right))) / wide, near + (1.35 * Math.abs(corner.dot(up))) / tall);
  }
  controls.target.copy(target);
  camera.position.copy(target).addScaledVector(ahead.applyAxisAngle(UP, actors[0].heading()), distance);
  controls.update();
  dirty = true;
}

function followTarget() {
  const next = actors[0].now.clone().add(actors[0].middle);
  const shift = next.clone().sub(target), turn = actors[0].heading() - heading;
  if (!Number.isFinite(shift.x)) return;
  if (mode !== "free") {
    camera.position.add(shift);
    controls.target.add(shift);
    if (mode === "ride") camera.position.sub(controls.target).applyAxisAngle(UP, turn).add(controls.target);
  }
  target = next;
  heading += turn;
}

function applyTheme() {
  document.documentElement.dataset.theme = theme;
  $("theme").textContent = theme === "dark" ? "Light" : "Dark";
  const sky = new THREE.Color(THEMES[theme].sky);
  view.background = sky;
  view.fog = new THREE.Fog(sky, 9 * extent, 34 * extent);
  surroundings.paint();
  for (const actor of actors) actor.ink();
  drawAll();
}

function drawAll() {
  for (const plot of plots) plot.draw();
  dirty = true;
}

function resize() {
  const { clientWidth: w, clientHeight: h } = $("stage");
  renderer?.setSize(w, h, false);
  camera.aspect = w / Math.max(h, 1);
  camera.updateProjectionMatrix();
  drawAll();
}

function frame(stamp) {
  requestAnimationFrame(frame);
  if (playing) {
    seek(now + (speed * Math.min(stamp - lastFrame, 250)) / 1000);
    frames.count += 1;
    if (stamp - frames.since > 1000) {
      frames.rate = (1000 * frames.count) / (stamp - frames.since);
      frames.count = 0; frames.since = stamp;
    }
    if (now >= end) play(false);
  }
  lastFrame = stamp;
  const isMoving = playing || stamp - quality.moved < 250;
  if (playing) quality.tell(stamp);
  if (!isMoving && !quality.isFine) dirty = true;
  if (!dirty) return;
  dirty = false;
  quality.set(!isMoving);
  for (const actor of actors) actor.pose(now);
  followTarget();
  controls.update();
  surroundings.follow(actors[0].now);
  renderer?.render(view, camera);
  $("clock").textContent = `${now.toFixed(2)} / ${end.toFixed(end < 10 ? 2 : 1)} s`;
  for (const plot of plots) plot.tell(now);
}

function addPlot(choice) {
  plots.push(new Plot(choice));
  drawAll();
}

$("play").addEventListener("click", () => play(!playing));
$("time").addEventListener("input", () => { quality.moved = performance.now(); seek(Number($("time").value)); });
$("speed").addEventListener("change", () => { speed = Number($("speed").value); });
$("camera").addEventListener("change", () => { mode = $("camera").value; if (mode === "ride") look("angle"); });
for (const button of document.querySelectorAll("[data-view]")) button.addEventListener("click", () => look(button.dataset.view));
$("hull").addEventListener("change", () => { actors.forEach((a) => a.showHull($("hull").value)); dirty = true; });
$("forces").addEventListener("change", () => { showForces = $("forces").checked; dirty = true; });
$("other").addEventListener("change", () => { actors.slice(1).forEach((a) => { a.group.visible = $("other").checked; }); dirty = true; });
$("panel").addEventListener("click", () => {
  $("side").hidden = !$("side").hidden;
  $("panel").setAttribute("aria-expanded", String(!$("side").hidden));
  resize();
});
$("theme").addEventListener("click", () => { theme = theme === "dark" ? "light" : "dark"; applyTheme(); });
$("add").addEventListener("click", () => addPlot(nextChoice()));
$("question").addEventListener("click", () => { $("help").hidden = !$("help").hidden; });
$("help").textContent = "space    play or pause\n← →      one picture back, on\nhome end first, last picture\n, .      slower, faster\n1 2 3 4  camera: angle, side, front, top\nC        what the camera does\nB F      body, forces\nP T      plots, light or dark\ndrag     turn; right button shifts, wheel zooms";

function nextChoice() {
  const taken = new Set(plots.map((plot) => plot.select.value));
  const free = scenes[0].panels.findIndex((_, k) => !taken.has(`p${k}`));
  return free >= 0 ? `p${free}` : "c0";
}

function cycle(select, step = 1) {
  const count = select.options.length;
  select.selectedIndex = Math.min(count - 1, Math.max(0, step === 0 ? (select.selectedIndex + 1) % count : select.selectedIndex + step));
  select.dispatchEvent(new Event("change"));
}

function flip(box) { box.checked = !box.checked; box.dispatchEvent(new Event("change")); }

const KEYS = {
  " ": () => play(!playing),
  ArrowLeft: () => { play(false); step(-1); }, ArrowRight: () => { play(false); step(1); },
  Home: () => seek(begin), End: () => seek(end),
  ",": () => cycle($("speed"), -1), ".": () => cycle($("speed"), 1),
  1: () => look("angle"), 2: () => look("side"), 3: () => look("front"), 4: () => look("top"),
  c: () => cycle($("camera"), 0), b: () => cycle($("hull"), 0), f: () => flip($("forces")),
  p: () => $("panel").click(), t: () => $("theme").click(), "?": () => $("question").click(),
};

function step(way) {
  const times = actors[0].times, [k, part] = locate(times, now);
  seek(times[Math.min(times.length - 1, Math.max(0, way > 0 ? k + 1 : part > 1e-9 ? k : k - 1))]);
}

addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const tag = event.target.tagName;
  if (tag === "SELECT" || (tag === "BUTTON" && event.key === " ") || (tag === "INPUT" && event.target.type === "checkbox" && event.key === " ")) return;
  if (tag === "INPUT" && ["Home", "End"].includes(event.key)) return;
  const act = KEYS[event.key] ?? KEYS[event.key.toLowerCase()];
  if (!act) return;
  event.preventDefault();
  act();
});
addEventListener("resize", resize);

$("hull-choice").hidden = !actors.some((a) => a.hulls.length);
$("forces-choice").hidden = !actors.some((a) => a.arrows.length);
const asked = new URLSearchParams(location.hash.slice(1));
if (asked.has("t") && Number.isFinite(Number(asked.get("t")))) seek(Number(asked.get("t")));
for (const actor of actors) actor.pose(now);
followTarget();
const shownFirst = Math.min(2, first.panels.length);
for (let k = 0; k < shownFirst; k++) plots.push(new Plot(`p${k}`));
if (!shownFirst && first.channels.length) plots.push(new Plot("c0"));
$("add").hidden = !first.channels.length;
applyTheme();
resize();
look(VIEWS[asked.get("view")] ? asked.get("view") : "angle");
requestAnimationFrame(frame);
// For tests and the curious: what the page shows at present.
window.animation = {
  state: () => ({
    time: now, begin, end, playing, frameRate: frames.rate, pictures: actors[0].times.length,
    camera: camera.position.toArray(), target: controls.target.toArray(), place: actors[0].now.toArray(),
    ratio: renderer?.getPixelRatio() ?? 0, triangles: renderer?.info.render.triangles ?? 0, calls: renderer?.info.render.calls ?? 0,
    marks: plots.map((plot) => plot.mark.getBoundingClientRect().left),
    colours: actors[0].coloured.map(({ mesh }) => `#${mesh.material.color.getHexString()}`),
    ticks: plots.map((plot) => plot.ticks ?? []),
    values: plots.map((plot) => plot.lines.map((line) => line.value.textContent)),
  }),
  seek, play,
};
document.documentElement.dataset.ready = "yes";
