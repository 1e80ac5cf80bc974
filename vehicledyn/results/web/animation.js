// The program of an animation's page: reads the data beside it, draws the scenes, plays them.
// Texts of the data are shown as text only. One idea a section, the start at the end.
"use strict";
(async () => {
  const $ = (id) => document.getElementById(id);
  const content = JSON.parse($("data").textContent);
  const columns = await unpack(content.columns, $("packed").textContent.trim());
  const scenes = content.scenes;
  const OKABE_ITO = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"];
  const TINTS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7"];

  // ---- columns of numbers -------------------------------------------------------------------

  async function unpack(describe, text) {
    const raw = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const stream = new Blob([raw]).stream().pipeThrough(new DecompressionStream("deflate"));
    const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
    let place = 0;
    return describe.map(([count, size, low, step]) => {
      const values = new Float64Array(count);
      if (size === 0) return values.fill(low);
      const whole = 256 ** size;
      let sum = 0;
      for (let k = 0; k < count; k++) {
        let difference = 0;
        for (let j = size - 1; j >= 0; j--) difference = difference * 256 + bytes[place + j * count + k];
        sum = (sum + difference) % whole;
        values[k] = sum === whole - 1 ? NaN : low + sum * step;
      }
      place += size * count;
      return values;
    });
  }

  // Largest index with times[index] <= t, and the part of the way to the next.
  function locate(times, t) {
    let low = 0, high = times.length - 1;
    if (high <= 0 || t <= times[0]) return [0, 0];
    if (t >= times[high]) return [high, 0];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle] <= t) low = middle; else high = middle;
    }
    const step = times[low + 1] - times[low];
    return [low, step > 0 ? (t - times[low]) / step : 0];
  }

  function between(column, [k, part]) {
    const a = column[k];
    return part === 0 ? a : a + part * (column[k + 1] - a);
  }

  // ---- looks --------------------------------------------------------------------------------

  const THEMES = {
    light: { sky: 0xe9eff4, floor: 0xdde4e9, grid: 0xb9c5cf, line: 0x33414d, trail: 0x0b6aa8, hull: 0x2f74ad },
    dark: { sky: 0x151b21, floor: 0x1e262d, grid: 0x394650, line: 0xb9c6d2, trail: 0x59b4ee, hull: 0x4a93cf },
  };
  const COLOURS = {
    arm: 0x4d5b68, rod: 0x7a8794, pin: 0x98a4af, guide: 0xa3aeb8, joint: 0x343f49, coil: 0xe2a11a,
    tyre: 0x262b30, rim: 0xc9d1d8, rail: 0x8c7a6b, steel: 0xaab4bd, force: 0xd8322a,
  };
  // Lines that colour-blind readers tell apart, on light and on dark ground (Okabe, Ito 2008).
  const LINES = { light: OKABE_ITO, dark: ["#56B4E9", "#F0A35C", "#3CC9A0", "#E39CC4", "#F0E442", "#B8C4FF"] };
  let theme = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";

  function material(colour, look = {}) {
    return new THREE.MeshLambertMaterial({ color: colour, ...look });
  }

  // A tone for a part of one result: its own colour, or the tint of a second result.
  function painter(index) {
    const known = new Map();
    return (colour, look = {}) => {
      const key = `${colour} ${JSON.stringify(look)}`;
      if (!known.has(key)) {
        const tint = new THREE.Color(colour);
        if (index > 0) tint.lerp(new THREE.Color(TINTS[index % TINTS.length]), 0.75);
        const ghost = index > 0 ? { transparent: true, opacity: 0.55 * (look.opacity ?? 1) } : {};
        known.set(key, material(tint, { ...look, ...ghost }));
      }
      return known.get(key);
    };
  }

  // ---- shapes -------------------------------------------------------------------------------

  const UP = new THREE.Vector3(0, 0, 1);

  function alongZ(a, b, mesh) {
    const d = b.clone().sub(a), length = d.length();
    mesh.position.copy(a);
    mesh.scale.z = Math.max(length, 1e-9);
    if (length > 1e-9) mesh.quaternion.setFromUnitVectors(UP, d.divideScalar(length));
    mesh.visible = Number.isFinite(length) && length > 1e-9;
  }

  // A cylinder of length 1 along z from the origin.
  function unitTube(radius, sides = 12) {
    return new THREE.CylinderGeometry(radius, radius, 1, sides).rotateX(Math.PI / 2).translate(0, 0, 0.5);
  }

  function unitCoil(radius, turns = 7) {
    const points = [];
    for (let k = 0; k <= turns * 12; k++) {
      const part = k / (turns * 12), angle = 2 * Math.PI * turns * part;
      points.push(new THREE.Vector3(radius * Math.cos(angle), radius * Math.sin(angle), 0.08 + 0.84 * part));
    }
    const curve = new THREE.CatmullRomCurve3(points);
    const wire = new THREE.TubeGeometry(curve, turns * 10, 0.16 * radius, 4);
    // The wire would be flattened along z when the unit length is scaled; its sides hide that.
    return wire;
  }

  function lathe(profile, segments) {
    const points = profile.map(([radius, along]) => new THREE.Vector2(Math.max(radius, 1e-6), along));
    return new THREE.LatheGeometry(points, segments); // about y
  }

  function wheelMesh(shape, paint) {
    const r = shape.radius, w = shape.width, group = new THREE.Group();
    const axis = new THREE.Vector3(...shape.axis).normalize();
    group.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), axis);
    group.position.set(...shape.at.point);
    const add = (geometry, colour, look) => group.add(new THREE.Mesh(geometry, paint(colour, look)));
    if (shape.style === "rail") {
      const rim = [[0.001, -0.5 * w], [0.3 * r, -0.5 * w], [0.34 * r, -0.1 * w], [0.76 * r, -0.12 * w], [0.8 * r, -0.5 * w], [r + 0.02, -0.52 * w], [r + 0.03, -0.44 * w], [r + 0.026, -0.34 * w], [r + 0.006, -0.24 * w], [r, 0], [r - 0.003, 0.44 * w], [r - 0.008, 0.48 * w], [0.82 * r, 0.48 * w], [0.76 * r, 0.04 * w], [0.34 * r, 0.06 * w], [0.3 * r, 0.5 * w], [0.001, 0.5 * w]];
      add(lathe(rim, 48), COLOURS.steel, { side: THREE.DoubleSide });
      marks(group, 0.55 * r, 0.09 * w, 0.045 * r, paint);
      return group;
    }
    if (shape.style === "disc") {
      const h = 0.5 * w;
      add(lathe([[0.9 * r, -h], [0.985 * r, -h], [r, -0.7 * h], [r, 0.7 * h], [0.985 * r, h], [0.9 * r, h], [0.9 * r, -h]], 56), COLOURS.arm);
      for (let k = 0; k < 8; k++) {
        const spoke = new THREE.Mesh(unitTube(0.018 * r, 6), paint(COLOURS.pin));
        spoke.quaternion.setFromUnitVectors(UP, new THREE.Vector3(Math.cos((k * Math.PI) / 4), 0, Math.sin((k * Math.PI) / 4)));
        spoke.scale.z = 0.92 * r;
        group.add(spoke);
      }
      add(lathe([[0.001, -1.4 * h], [0.08 * r, -1.4 * h], [0.08 * r, 1.4 * h], [0.001, 1.4 * h]], 16), COLOURS.joint);
      return group;
    }
    const h = 0.5 * w;
    add(lathe([[0.62 * r, -0.86 * h], [0.8 * r, -h], [0.93 * r, -0.96 * h], [0.985 * r, -0.8 * h], [r, -0.5 * h], [r, 0.5 * h], [0.985 * r, 0.8 * h], [0.93 * r, 0.96 * h], [0.8 * r, h], [0.62 * r, 0.86 * h]], 36), COLOURS.tyre, { side: THREE.DoubleSide });
    add(lathe([[0.001, -0.3 * h], [0.2 * r, -0.3 * h], [0.55 * r, -0.62 * h], [0.63 * r, -0.84 * h], [0.63 * r, 0.84 * h], [0.55 * r, 0.62 * h], [0.2 * r, 0.3 * h], [0.001, 0.3 * h]], 20), COLOURS.rim);
    marks(group, 0.42 * r, 0.56 * h, 0.075 * r, paint);
    return group;
  }

  // Holes in a wheel's disc: without them one does not see it turn.
  function marks(group, radius, height, size, paint) {
    const shape = new THREE.CylinderGeometry(size, size, 0.02 * radius + 0.004, 8);
    for (const [colour, first, last] of [[0x0b6aa8, 0, 1], [0x59636c, 1, 5]]) {
      const holes = new THREE.InstancedMesh(shape, paint(colour), 2 * (last - first));
      for (let k = first; k < last; k++) {
        const angle = (k * 2 * Math.PI) / 5, x = radius * Math.cos(angle), z = radius * Math.sin(angle);
        for (const side of [0, 1]) holes.setMatrixAt(2 * (k - first) + side, new THREE.Matrix4().makeTranslation(x, (2 * side - 1) * height, z));
      }
      group.add(holes);
    }
  }

  // Height of a hull's cabin, which is as tall as cars of that length have it.
  function roof({ outline, top }) {
    const xs = outline.map((p) => p[0]);
    return top + 0.24 * Math.min(Math.max(...xs) - Math.min(...xs), 4.5);
  }

  // The silhouette of a vehicle, drawn across its width; wheels cut arches into it.
  function hullMesh(shape, wheels, paint) {
    const xs = shape.outline.map((p) => p[0]), ys = shape.outline.map((p) => p[1]);
    const front = Math.max(...xs), rear = Math.min(...xs), left = Math.max(...ys), right = Math.min(...ys);
    const length = front - rear, height = shape.top - shape.bottom, cabin = roof(shape);
    const at = (part) => front - part * length;
    const profile = new THREE.Shape();
    profile.moveTo(rear, shape.bottom + 0.1 * height);
    const arches = wheels.filter((w) => w.x > rear && w.x < front).sort((a, b) => a.x - b.x);
    let last = rear;
    for (const wheel of arches) {
      const reach = 1.16 * wheel.radius, drop = Math.max(-1, Math.min(1, (shape.bottom - wheel.z) / reach));
      const half = reach * Math.sqrt(1 - drop * drop);
      if (drop >= 1 || wheel.x - half <= last || wheel.x + half >= front) continue;
      profile.lineTo(wheel.x - half, shape.bottom);
      const angle = Math.asin(drop);
      profile.absarc(wheel.x, wheel.z, reach, Math.PI - angle, angle, true);
      last = wheel.x + half;
    }
    profile.lineTo(front - 0.02 * length, shape.bottom);
    profile.lineTo(front, shape.bottom + 0.25 * height);
    profile.lineTo(front, shape.top - 0.16 * height);
    profile.lineTo(at(0.03), shape.top - 0.04 * height);
    profile.lineTo(at(0.3), shape.top + 0.04 * height);
    profile.lineTo(at(0.4), cabin);
    profile.lineTo(at(0.95), cabin);
    profile.lineTo(rear, shape.top);
    profile.closePath();
    const width = left - right, bevel = 0.05 * width;
    const geometry = new THREE.ExtrudeGeometry(profile, { depth: width - 2 * bevel, bevelEnabled: true, bevelThickness: bevel, bevelSize: 0.02 * width, bevelOffset: -0.02 * width, bevelSegments: 2, curveSegments: 14 });
    geometry.translate(0, 0, -0.5 * width + bevel).rotateX(Math.PI / 2).translate(0, 0.5 * (left + right), 0);
    const mesh = new THREE.Mesh(geometry, paint("hull", { transparent: true, opacity: 0.24, side: THREE.DoubleSide, depthWrite: false, forceSinglePass: true }));
    mesh.renderOrder = 2;
    const edges = new THREE.LineSegments(new THREE.EdgesGeometry(geometry, 28), new THREE.LineBasicMaterial({ transparent: true, opacity: 0.55 }));
    edges.userData.ink = true;
    const group = new THREE.Group();
    group.add(mesh, edges);
    group.userData.hull = mesh;
    return group;
  }

  function boxMesh(shape, paint, colour) {
    const geometry = new THREE.BoxGeometry(...shape.size);
    const group = new THREE.Group();
    const glass = { transparent: true, opacity: 0.28, side: THREE.DoubleSide, depthWrite: false, forceSinglePass: true };
    const block = new THREE.Mesh(geometry, shape.style === "glass" ? paint(colour, glass) : paint(colour));
    if (shape.style === "glass") block.renderOrder = 2;
    group.add(block);
    const edges = new THREE.LineSegments(new THREE.EdgesGeometry(geometry), new THREE.LineBasicMaterial({ transparent: true, opacity: 0.5 }));
    edges.userData.ink = true;
    group.add(edges);
    group.position.set(...shape.at.point);
    if (shape.rotation) {
      const [a, b, c] = shape.rotation;
      group.quaternion.setFromRotationMatrix(new THREE.Matrix4().set(a[0], a[1], a[2], 0, b[0], b[1], b[2], 0, c[0], c[1], c[2], 0, 0, 0, 0, 1));
    }
    return group;
  }

  function arrowMesh(colour) {
    const group = new THREE.Group(), paint = new THREE.MeshLambertMaterial({ color: colour, emissive: colour, emissiveIntensity: 0.35, transparent: true, opacity: 0.92, depthTest: false });
    group.shaft = new THREE.Mesh(unitTube(1, 10), paint);
    group.head = new THREE.Mesh(new THREE.ConeGeometry(2.4, 6, 14).rotateX(Math.PI / 2).translate(0, 0, 3), paint);
    // Seen through all else: most of a force at a tyre lies inside of the wheel.
    group.shaft.renderOrder = group.head.renderOrder = 5;
    group.add(group.shaft, group.head);
    return group;
  }

  // A section (across, up) along a line of points, leaning by the slopes across.
  function sweep(points, section, slopes) {
    const vertices = [], faces = [], count = section.length;
    for (let k = 0; k < points.length; k++) {
      const a = points[Math.max(k - 1, 0)], b = points[Math.min(k + 1, points.length - 1)];
      const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
      const left = [-(b[1] - a[1]) / length, (b[0] - a[0]) / length];
      for (const [across, up] of section) vertices.push(points[k][0] + left[0] * across, points[k][1] + left[1] * across, points[k][2] + up + slopes[k] * across);
      if (k) for (let j = 0; j < count; j++) {
        const n = (j + 1) % count, p = (k - 1) * count, q = k * count;
        faces.push(p + j, q + j, q + n, p + j, q + n, p + n);
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(vertices), 3));
    geometry.setIndex(faces);
    const flat = geometry.toNonIndexed();
    flat.computeVertexNormals();
    return flat;
  }

  // ---- one result in the scene -------------------------------------------------------------

  class Actor {
    constructor(scene, index) {
      this.data = scene;
      this.group = new THREE.Group();
      this.times = columns[scene.time];
      this.origin = scene.origin.map((c) => columns[c]);
      this.paint = painter(index);
      this.nodes = new Map();
      this.moving = [];
      this.hulls = [];
      scene.bodies.forEach((body, k) => this.addBody(body, k));
      const ground = new THREE.Group();
      this.group.add(ground);
      this.nodes.set("ground", { frame: ground, spinner: ground, index: -1, fixed: true });
      this.pose(this.times[0]);
      this.extent = this.measure();
      const wheels = this.wheelsOf();
      for (const shape of scene.shapes) this.addShape(shape, wheels);
      this.arrows = scene.arrows.map((arrow) => this.addArrow(arrow));
      this.reach = Math.min(this.extent, 6);
      this.perNewton = scene.usual_force > 0 ? (0.28 * this.reach) / scene.usual_force : 0;
      this.ink();
    }

    addBody(body, index) {
      const carrier = new THREE.Group(), spinner = body.axis ? new THREE.Group() : carrier;
      if (body.axis) carrier.add(spinner);
      this.group.add(carrier);
      this.nodes.set(body.name, {
        index, carrier, spinner, frame: body.axes_spin ? spinner : carrier,
        position: body.position.map((c) => columns[c]), quaternion: body.quaternion.map((c) => columns[c]),
        turn: body.turn === null ? null : columns[body.turn], axis: new THREE.Vector3().setComponent(Math.max(body.axis - 1, 0), 1),
      });
    }

    // Size of what is seen [m], and its middle from the first body; where that body stays in its
    // place, over many pictures.
    measure() {
      const [x, y, z] = this.origin, n = this.times.length, spans = [x, y, z].map((c) => { const known = c.filter(Number.isFinite); return known.length ? known.reduce((a, b) => Math.max(a, b)) - known.reduce((a, b) => Math.min(a, b)) : 0; });
      const once = this.span([this.times[0]]);
      const stays = Math.hypot(...spans) < once.size;
      const whole = stays && n > 1 ? this.span(Array.from({ length: 24 }, (_, k) => this.times[Math.round((k * (n - 1)) / 23)])) : once;
      this.pose(this.times[0]);
      this.low = whole.low;
      this.middle = whole.middle.sub(this.first());
      this.half = whole.half;
      return whole.size;
    }

    span(times) {
      const low = new THREE.Vector3(Infinity, Infinity, Infinity), high = low.clone().negate();
      const take = (anchor) => {
        if (!anchor || !anchor.body || anchor.body === "ground") return;
        const p = this.place(anchor);
        if (Number.isFinite(p.x + p.y + p.z)) { low.min(p); high.max(p); }
      };
      for (const time of times) {
        this.pose(time);
        for (const shape of this.data.shapes) {
          [shape.a, shape.b, shape.at].forEach(take);
          if (shape.kind === "hull") for (const [x, y] of shape.outline) for (const z of [shape.bottom, roof(shape)]) take({ body: shape.body, point: [x, y, z] });
          if (shape.kind === "box") for (const s of [-0.5, 0.5]) take({ body: shape.at.body, point: shape.at.point.map((p, k) => p + s * shape.size[k]) });
          if (shape.kind === "wheel") for (const s of [-1, 1]) take({ body: shape.at.body, point: [shape.at.point[0] + s * shape.radius, shape.at.point[1], shape.at.point[2]] });
        }
      }
      const size = high.clone().sub(low).length();
      if (!Number.isFinite(size) || size < 1e-6) return { size: 1, low: 0, middle: this.first(), half: new THREE.Vector3(0.3, 0.3, 0.3) };
      return { size, low: low.z, middle: low.clone().add(high).multiplyScalar(0.5), half: high.clone().sub(low).multiplyScalar(0.5) };
    }

    first() { return new THREE.Vector3(...this.origin.map((c) => c[0] || 0)); }

    wheelsOf() {
      const found = [];
      for (const shape of this.data.shapes) if (shape.kind === "wheel") found.push({ place: this.place(shape.at), radius: shape.radius });
      return found;
    }

    place(anchor) {
      const node = this.nodes.get(anchor.body), point = new THREE.Vector3(...anchor.point);
      return node ? node.frame.localToWorld(point) : point;
    }

    addShape(shape, wheels) {
      const node = (name) => this.nodes.get(name) || this.nodes.get("ground");
      const colours = this.data.shapes.some((s) => s.kind === "hull") ? () => COLOURS.arm : (name) => OKABE_ITO[Math.max(node(name).index, 0) % OKABE_ITO.length];
      const add = (mesh, body, spins = false) => (spins ? node(body).spinner : node(body).frame).add(mesh);
      if (shape.kind === "box") add(boxMesh(shape, this.paint, shape.style === "steel" ? COLOURS.steel : colours(shape.at.body)), shape.at.body);
      else if (shape.kind === "ball") {
        const mesh = new THREE.Mesh(new THREE.SphereGeometry(shape.radius, 20, 14), this.paint(shape.style === "body" ? colours(shape.at.body) : shape.style === "rubber" ? COLOURS.tyre : COLOURS.joint));
        mesh.position.set(...shape.at.point);
        add(mesh, shape.at.body);
      } else if (shape.kind === "wheel") add(wheelMesh(shape, this.paint), shape.at.body, true);
      else if (shape.kind === "hull") {
        const chassis = node(shape.body).frame;
        const inside = wheels.map((w) => ({ ...chassis.worldToLocal(w.place.clone()), radius: w.radius }));
        const mesh = hullMesh(shape, inside, (_, look) => this.paint(THEMES.light.hull, look));
        this.hulls.push(mesh);
        add(mesh, shape.body);
      } else if (shape.kind === "tube") {
        const mesh = new THREE.Mesh(unitTube(shape.radius), this.paint(shape.style === "arm" ? colours(shape.a.body) : COLOURS[shape.style] ?? COLOURS.rod));
        if (shape.a.body === shape.b.body) {
          alongZ(new THREE.Vector3(...shape.a.point), new THREE.Vector3(...shape.b.point), mesh);
          add(mesh, shape.a.body);
        } else this.stretch(mesh, shape);
      } else if (shape.kind === "coil") {
        this.stretch(new THREE.Mesh(unitCoil(shape.radius), this.paint(COLOURS.coil)), shape);
        this.stretch(new THREE.Mesh(unitTube(0.28 * shape.radius, 8), this.paint(COLOURS.rod)), shape);
      }
    }

    stretch(mesh, shape) {
      this.group.add(mesh);
      this.moving.push({ mesh, a: shape.a, b: shape.b, direction: shape.direction });
    }

    addArrow(arrow) {
      const mesh = arrowMesh(COLOURS.force);
      this.group.add(mesh);
      return { mesh, foot: arrow.foot.map((c) => columns[c]), force: arrow.force.map((c) => columns[c]) };
    }

    ink() {
      this.group.traverse((item) => { if (item.userData.ink) item.material.color.set(THEMES[theme].line); });
    }

    pose(t) {
      const spot = locate(this.times, t), [k, part] = spot;
      const origin = this.origin.map((c) => between(c, spot));
      if (Number.isFinite(origin[0] + origin[1] + origin[2]) || !this.now) this.now = new THREE.Vector3(...origin.map((value) => value || 0));
      const a = new THREE.Quaternion(), b = new THREE.Quaternion();
      for (const node of this.nodes.values()) {
        if (node.fixed) continue;
        const place = node.position.map((c, i) => origin[i] + between(c, spot));
        const at = (q, row) => q.set(node.quaternion[1][row], node.quaternion[2][row], node.quaternion[3][row], node.quaternion[0][row]).normalize();
        at(a, k);
        if (part > 0) a.slerp(at(b, k + 1), part);
        const known = Number.isFinite(place[0] + place[1] + place[2] + a.w);
        node.carrier.visible = known;
        if (!known) continue;
        node.carrier.position.set(...place);
        node.carrier.quaternion.copy(a);
        if (node.turn) node.spinner.quaternion.setFromAxisAngle(node.axis, between(node.turn, spot) || 0);
      }
      this.group.updateMatrixWorld(true);
      for (const { mesh, a: from, b: to, direction } of this.moving) {
        const hidden = [from, to].some((anchor) => this.nodes.get(anchor.body)?.carrier?.visible === false);
        if (hidden) { mesh.visible = false; continue; }
        const start = this.place(from), stop = this.place(to);
        if (direction) {
          const tip = from.point.map((value, i) => value + direction[i]);
          const along = this.place({ body: from.body, point: tip }).sub(start);
          start.copy(stop).addScaledVector(along, along.dot(start.clone().sub(stop)));
        }
        alongZ(start, stop, mesh);
      }
      for (const { mesh, foot, force } of this.arrows ?? []) {
        const end = new THREE.Vector3(...force.map((c) => between(c, spot))).multiplyScalar(this.perNewton);
        const start = new THREE.Vector3(...foot.map((c, i) => origin[i] + between(c, spot)));
        end.clampLength(0, 0.7 * this.reach);
        const length = end.length(), thick = 0.0045 * this.reach;
        mesh.visible = showForces && Number.isFinite(length + start.x) && length > 4 * thick;
        if (!mesh.visible) continue;
        mesh.position.copy(start);
        mesh.quaternion.setFromUnitVectors(UP, end.divideScalar(length));
        const head = Math.min(6 * thick, 0.5 * length);
        mesh.shaft.scale.set(thick, thick, length - head);
        mesh.head.scale.set(thick, thick, head / 6);
        mesh.head.position.z = length - head;
      }
    }

    // Heading of the first body [rad], from its x axis.
    heading() {
      const node = this.nodes.get(this.data.bodies[0].name);
      const ahead = new THREE.Vector3(1, 0, 0).applyQuaternion(node.carrier.quaternion);
      return Math.hypot(ahead.x, ahead.y) > 1e-6 ? Math.atan2(ahead.y, ahead.x) : 0;
    }

    showHull(how) {
      for (const hull of this.hulls) {
        hull.visible = how !== "hidden";
        const look = hull.userData.hull.material;
        look.opacity = how === "solid" ? 1 : 0.24;
        look.transparent = how !== "solid";
        look.depthWrite = how === "solid";
        look.needsUpdate = true;
      }
    }
  }

  // ---- what stands still --------------------------------------------------------------------

  class Surroundings {
    constructor(actor) {
      this.group = new THREE.Group();
      this.actor = actor;
      this.extent = actor.extent;
      const power = 10 ** Math.floor(Math.log10(this.extent / 2));
      this.cell = power * [1, 2, 5, 10].find((n) => n * power >= this.extent / 2.5);
      const plane = actor.data.shapes.find((s) => s.kind === "plane");
      const track = actor.data.track?.map((edge) => edge.map((c) => columns[c]));
      this.floor = new THREE.Group();
      this.slope = new THREE.Group();
      this.slope.add(this.floor);
      this.group.add(this.slope);
      this.isGround = Boolean(plane);
      if (plane) {
        this.slope.position.set(...plane.point);
        this.slope.quaternion.setFromUnitVectors(UP, new THREE.Vector3(...plane.normal).normalize());
      } else {
        const lowest = actor.data.ground ? Math.min(...columns[actor.data.ground.points[2]]) - 0.02 : track ? Math.min(...track[0][2], ...track[1][2]) - 0.452 : this.lowest() - 0.12 * this.extent;
        this.slope.position.z = lowest;
      }
      const size = 60 * this.cell;
      // Drawn before all else and without depth: nothing it carries fights with it.
      this.sheet = new THREE.Mesh(new THREE.PlaneGeometry(4 * size, 4 * size), new THREE.MeshBasicMaterial({ depthWrite: false }));
      this.sheet.renderOrder = -2;
      this.tile = document.createElement("canvas");
      this.tile.width = this.tile.height = 512;
      this.grid = new THREE.CanvasTexture(this.tile);
      this.grid.wrapS = this.grid.wrapT = THREE.RepeatWrapping;
      this.grid.repeat.set((4 * size) / this.cell, (4 * size) / this.cell);
      this.grid.anisotropy = isSlow ? 1 : 8;
      if (isSlow) this.grid.minFilter = THREE.LinearMipmapNearestFilter;
      this.grid.colorSpace = THREE.SRGBColorSpace;
      this.sheet.material.map = this.grid;
      this.floor.add(this.sheet);
      this.addCones(actor.data.cones);
      if (actor.data.ground) this.addGround(actor.data.ground);
      if (track) this.addTrack(...track.map(([x, y, z]) => Array.from(x, (_, k) => [x[k], y[k], z[k]])));
      this.addTrail(actor);
    }

    // Lowest place that the bodies reach, from some pictures.
    lowest() {
      let low = this.actor.low;
      const n = this.actor.times.length;
      for (let k = 0; k < n; k += Math.max(1, Math.floor(n / 60))) {
        this.actor.pose(this.actor.times[k]);
        for (const shape of this.actor.data.shapes) for (const anchor of [shape.a, shape.b, shape.at]) {
          if (!anchor || !anchor.body) continue;
          const z = this.actor.place(anchor).z;
          if (z < low) low = z;
        }
      }
      this.actor.pose(this.actor.times[0]);
      return low;
    }

    addCones({ feet, radius }) {
      if (!feet.length) return;
      const r = radius || 0.15, h = 3.6 * r;
      const parts = [
        [new THREE.CylinderGeometry(0.13 * r, 0.82 * r, h, 20).rotateX(Math.PI / 2).translate(0, 0, h / 2 + 0.03), 0xf06a12],
        [new THREE.CylinderGeometry(0.405 * r, 0.59 * r, 0.27 * h, 20).rotateX(Math.PI / 2).translate(0, 0, 0.5 * h + 0.03), 0xfafafa],
        [new THREE.BoxGeometry(2 * r, 2 * r, 0.06).translate(0, 0, 0.03), 0xc9520a],
      ];
      for (const [geometry, colour] of parts) {
        const mesh = new THREE.InstancedMesh(geometry, material(colour), feet.length);
        feet.forEach(([x, y], k) => mesh.setMatrixAt(k, new THREE.Matrix4().makeTranslation(x, y, 0)));
        this.group.add(mesh);
      }
    }

    addGround({ rows, columns: across, points }) {
      const [x, y, z] = points.map((c) => columns[c]), vertices = new Float32Array(3 * rows * across), faces = [];
      const base = [x[0], y[0], 0];
      for (let k = 0; k < rows * across; k++) vertices.set([x[k] - base[0], y[k] - base[1], z[k]], 3 * k);
      for (let i = 0; i + 1 < rows; i++) for (let j = 0; j + 1 < across; j++) {
        const a = i * across + j, b = a + across;
        faces.push(a, b, b + 1, a, b + 1, a + 1);
      }
      const places = new Float32Array(2 * rows * across);
      let way = 0;
      for (let i = 0; i < rows; i++) {
        const k = i * across;
        if (i) way += Math.hypot(x[k] - x[k - across], y[k] - y[k - across]);
        for (let j = 0; j < across; j++) places.set([(2 * way) / this.cell, (2 * Math.hypot(x[k + j] - x[k], y[k + j] - y[k])) / this.cell], 2 * (k + j));
      }
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(vertices, 3));
      geometry.setAttribute("uv", new THREE.BufferAttribute(places, 2));
      geometry.setIndex(faces);
      geometry.computeVertexNormals();
      this.roadGrid = new THREE.CanvasTexture(this.tile);
      this.roadGrid.wrapS = this.roadGrid.wrapT = THREE.RepeatWrapping;
      this.roadGrid.colorSpace = THREE.SRGBColorSpace;
      this.road = new THREE.Mesh(geometry, material(0xffffff, { side: THREE.DoubleSide, map: this.roadGrid }));
      this.road.position.set(...base);
      this.group.add(this.road);
    }

    addTrack(left, right) {
      const base = left[0], local = (line) => line.map((p) => [p[0] - base[0], p[1] - base[1], p[2] - base[2]]);
      const holder = new THREE.Group();
      holder.position.set(...base);
      this.group.add(holder);
      const sides = [[local(left), 1], [local(right), -1]];
      const slopes = left.map((l, k) => (l[2] - right[k][2]) / (Math.hypot(l[0] - right[k][0], l[1] - right[k][1]) || 1));
      for (const [line, side] of sides) {
        // Head, web and foot of a rail; points are the running edge, the rail lies outside of it.
        const section = [[0.005, 0], [0.067, 0], [0.072, -0.03], [0.045, -0.05], [0.045, -0.14], [0.11, -0.16], [0.11, -0.172], [-0.04, -0.172], [-0.04, -0.16], [0.027, -0.14], [0.027, -0.05], [0, -0.03]];
        const turned = section.map(([a, u]) => [side * a, u]);
        holder.add(new THREE.Mesh(sweep(line, side > 0 ? turned : turned.reverse(), slopes), material(COLOURS.rail, { side: THREE.DoubleSide })));
      }
      const a = sides[0][0], b = sides[1][0], spots = [];
      let rest = 0;
      for (let k = 1; k < a.length; k++) {
        const step = Math.hypot(a[k][0] - a[k - 1][0], a[k][1] - a[k - 1][1]);
        for (; rest < step; rest += 0.6) {
          const part = step > 0 ? rest / step : 0, mix = (line) => line[k - 1].map((p, i) => p + part * (line[k][i] - p));
          spots.push([mix(a), mix(b)]);
        }
        rest -= step;
      }
      const count = Math.min(spots.length, 20000);
      const sleepers = new THREE.InstancedMesh(new THREE.BoxGeometry(0.26, 2.5, 0.2), material(0x77706a), count);
      for (let k = 0; k < count; k++) {
        const l = new THREE.Vector3(...spots[k][0]), r = new THREE.Vector3(...spots[k][1]);
        const y = l.clone().sub(r).normalize(), x = new THREE.Vector3().crossVectors(y, UP).normalize(), z = new THREE.Vector3().crossVectors(x, y);
        const matrix = new THREE.Matrix4().makeBasis(x, y, z).setPosition(l.add(r).multiplyScalar(0.5).add(z.multiplyScalar(-0.275)));
        sleepers.setMatrixAt(k, matrix);
      }
      holder.add(sleepers);
      const middle = a.map((p, k) => p.map((v, i) => 0.5 * (v + b[k][i])));
      holder.add(new THREE.Mesh(sweep(middle, [[1.7, -0.2], [-1.7, -0.2], [-2.4, -0.45], [2.4, -0.45]], slopes), material(0xa39c94, { side: THREE.DoubleSide })));
    }

    // The way of the first body over the ground.
    addTrail(actor) {
      const [x, y, z] = actor.origin, n = x.length, points = [];
      let way = 0;
      for (let k = 1; k < n; k++) way += Math.hypot(x[k] - x[k - 1], y[k] - y[k - 1]) || 0;
      const isRoad = this.isGround || actor.data.ground;
      if (!isRoad || !(way > 0.5 * this.extent)) return;
      const first = actor.first();
      for (let k = 0; k < n; k++) {
        if (!Number.isFinite(x[k])) continue;
        const foot = this.isGround ? this.onPlane(x[k], y[k]) : z[k];
        points.push(x[k] - first.x, y[k] - first.y, foot + 0.004 * this.extent);
      }
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
      this.trail = new THREE.Line(geometry, new THREE.LineBasicMaterial({ transparent: true, opacity: 0.6 }));
      this.trail.position.set(first.x, first.y, 0);
      this.group.add(this.trail);
    }

    onPlane(x, y) {
      const n = UP.clone().applyQuaternion(this.slope.quaternion), p = this.slope.position;
      return p.z - (n.x * (x - p.x) + n.y * (y - p.y)) / n.z;
    }

    // Keep the endless floor beneath a place, in whole cells.
    follow(place) {
      const local = this.slope.worldToLocal(place.clone());
      this.floor.position.set(Math.round(local.x / this.cell) * this.cell, Math.round(local.y / this.cell) * this.cell, 0);
    }

    paint() {
      const look = THEMES[theme];
      const pen = this.tile.getContext("2d"), hex = (colour) => `#${colour.toString(16).padStart(6, "0")}`;
      pen.fillStyle = hex(look.floor);
      pen.fillRect(0, 0, 512, 512);
      pen.fillStyle = hex(look.grid);
      for (const edge of [0, 510]) { pen.fillRect(edge, 0, 2, 512); pen.fillRect(0, edge, 512, 2); }
      this.grid.needsUpdate = true;
      this.trail?.material.color.set(look.trail);
      if (this.roadGrid) this.roadGrid.needsUpdate = true;
    }
  }

  // ---- plots --------------------------------------------------------------------------------

  const byName = scenes.map((scene) => new Map(scene.channels.map((channel) => [channel.name, channel])));

  function niceTicks(low, high, count) {
    const span = high - low || Math.abs(high) || 1, raw = span / count, power = 10 ** Math.floor(Math.log10(raw));
    const step = power * [1, 2, 5, 10].find((n) => n * power >= raw), ticks = [];
    for (let v = Math.ceil(low / step - 1e-9) * step; v <= high + 1e-9 * span; v += step) ticks.push(Math.abs(v) < 1e-9 * span ? 0 : v);
    return ticks.length > 1 || !(span > 0) || count > 64 ? ticks : niceTicks(low, high, 2 * count);
  }

  function shown(value) {
    if (!Number.isFinite(value)) return "–";
    const size = Math.abs(value);
    return size !== 0 && (size >= 1e5 || size < 1e-3) ? value.toExponential(2) : Number(value.toPrecision(4)).toString();
  }

  class Plot {
    constructor(choice) {
      this.root = document.createElement("div");
      this.root.className = "plot";
      const head = element(this.root, "div", "head");
      this.select = element(head, "select");
      this.select.setAttribute("aria-label", "What this plot shows");
      const figures = element(this.select, "optgroup");
      figures.label = "Figures";
      scenes[0].panels.forEach((panel, k) => { const o = element(figures, "option"); o.value = `p${k}`; o.textContent = `${panel.title} [${byName[0].get(panel.channels[0]).unit}]`; });
      const all = element(this.select, "optgroup");
      all.label = "Channels";
      scenes[0].channels.forEach((channel, k) => { const o = element(all, "option"); o.value = `c${k}`; o.textContent = channel.name; });
      if (!scenes[0].panels.length) figures.remove();
      this.select.value = choice;
      this.select.addEventListener("change", () => { this.choose(); drawAll(); });
      const remove = element(head, "button");
      remove.type = "button"; remove.textContent = "×"; remove.setAttribute("aria-label", "Remove this plot");
      remove.addEventListener("click", () => { this.root.remove(); plots.splice(plots.indexOf(this), 1); });
      this.area = element(this.root, "div", "area");
      this.canvas = element(this.area, "canvas");
      this.mark = element(this.area, "div", "mark");
      this.list = element(this.root, "ul");
      const drag = (event) => {
        if (event.type === "pointermove" && !event.buttons) return;
        const box = this.area.getBoundingClientRect(), part = (event.clientX - box.left - this.left) / (box.width - this.left - 8);
        seek(begin + Math.min(1, Math.max(0, part)) * (end - begin));
      };
      this.area.addEventListener("pointerdown", (event) => { this.area.setPointerCapture(event.pointerId); drag(event); });
      this.area.addEventListener("pointermove", drag);
      $("plots").append(this.root);
      this.choose();
    }

    choose() {
      const number = Number(this.select.value.slice(1));
      const names = this.select.value[0] === "p" ? scenes[0].panels[number].channels : [scenes[0].channels[number].name];
      this.lines = [];
      names.forEach((name, k) => scenes.forEach((scene, i) => {
        const channel = byName[i].get(name);
        if (channel) this.lines.push({ channel, scene: i, colour: k % OKABE_ITO.length, dashed: i > 0, values: columns[channel.column], times: columns[scene.time] });
      }));
      this.unit = this.lines[0]?.channel.unit ?? "";
      this.list.replaceChildren();
      for (const line of this.lines) {
        const item = element(this.list, "li"), mark = element(item, "i");
        line.mark = mark;
        if (line.dashed) mark.style.borderTopStyle = "dashed";
        const text = element(item, "span");
        text.textContent = line.channel.name;
        text.title = line.channel.text;
        line.value = element(item, "b");
      }
      this.canvas.setAttribute("role", "img");
      this.canvas.setAttribute("aria-label", `${names.join(", ")} against time`);
    }

    draw() {
      const ratio = devicePixelRatio || 1, { clientWidth: w, clientHeight: h } = this.area;
      if (!w) return;
      this.canvas.width = w * ratio;
      this.canvas.height = h * ratio;
      const pen = this.canvas.getContext("2d");
      pen.scale(ratio, ratio);
      const style = getComputedStyle(document.documentElement), ink = style.getPropertyValue("--soft"), rule = style.getPropertyValue("--line");
      pen.font = "11px system-ui, 'DejaVu Sans', sans-serif";
      let low = Infinity, high = -Infinity;
      for (const { values, channel } of this.lines) for (const v of values) {
        const x = v * channel.factor;
        if (x < low) low = x;
        if (x > high) high = x;
      }
      if (!(high >= low)) { low = 0; high = 1; }
      const room = high - low || Math.abs(high) || 1;
      low -= 0.05 * room; high += 0.05 * room;
      const ticks = niceTicks(low, high, 4), top = 16, bottom = h - 20;
      this.ticks = ticks;
      this.left = Math.ceil(Math.max(...ticks.map((t) => pen.measureText(shown(t)).width))) + 10;
      const X = (t) => this.left + ((t - begin) / (end - begin || 1)) * (w - this.left - 8);
      const Y = (v) => bottom - ((v - low) / (high - low)) * (bottom - top);
      pen.lineWidth = 1; pen.strokeStyle = rule; pen.fillStyle = ink;
      pen.textAlign = "right"; pen.textBaseline = "middle";
      for (const t of ticks) {
        pen.beginPath(); pen.moveTo(this.left, Math.round(Y(t)) + 0.5); pen.lineTo(w - 8, Math.round(Y(t)) + 0.5); pen.stroke();
        pen.fillText(shown(t), this.left - 5, Y(t));
      }
      pen.textAlign = "center"; pen.textBaseline = "top";
      for (const t of niceTicks(begin, end, 5)) pen.fillText(shown(t), X(t), bottom + 5);
      pen.textAlign = "left"; pen.fillText(`[${this.unit}]`, 2, 0);
      pen.textAlign = "right"; pen.fillText("t [s]", w - 8, 0);
      pen.save(); pen.beginPath(); pen.rect(this.left, top - 4, w - this.left - 8, bottom - top + 8); pen.clip();
      for (const { values, times, channel, colour, dashed } of this.lines) {
        pen.strokeStyle = LINES[theme][colour]; pen.lineWidth = dashed ? 1.3 : 1.7; pen.setLineDash(dashed ? [5, 3] : []);
        pen.beginPath();
        let down = false;
        for (let k = 0; k < values.length; k++) {
          if (!Number.isFinite(values[k])) { down = false; continue; }
          const x = X(times[k]), y = Y(values[k] * channel.factor);
          if (down) pen.lineTo(x, y); else pen.moveTo(x, y);
          down = true;
        }
        pen.stroke();
      }
      pen.restore();
      for (const line of this.lines) line.mark.style.borderTopColor = LINES[theme][line.colour];
      this.width = w - this.left - 8;
    }

    tell(t) {
      const part = (t - begin) / (end - begin || 1);
      this.mark.style.transform = `translateX(${this.left + part * this.width}px)`;
      for (const { values, times, channel, value } of this.lines) value.textContent = shown(between(values, locate(times, t)) * channel.factor);
    }
  }

  function element(parent, tag, name) {
    const made = document.createElement(tag);
    if (name) made.className = name;
    parent.append(made);
    return made;
  }

  function drawsOnProcessor() {
    const context = document.createElement("canvas").getContext("webgl2");
    const names = context?.getExtension("WEBGL_debug_renderer_info");
    const name = names ? String(context.getParameter(names.UNMASKED_RENDERER_WEBGL)) : "";
    context?.getExtension("WEBGL_lose_context")?.loseContext();
    return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
  }

  // ---- the clock ----------------------------------------------------------------------------

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

  // ---- start --------------------------------------------------------------------------------

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
      ticks: plots.map((plot) => plot.ticks ?? []),
      values: plots.map((plot) => plot.lines.map((line) => line.value.textContent)),
    }),
    seek, play,
  };
  document.documentElement.dataset.ready = "yes";
})().catch((error) => {
  const place = document.getElementById("warning");
  place.hidden = false;
  place.textContent = `This page cannot be shown: ${error.message}`;
  throw error;
});
