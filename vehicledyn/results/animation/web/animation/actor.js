// One result in the scene: its bodies, links and forces at a time.

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
    this.coloured = [];
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
    else if (shape.kind === "extrusion") add(extrusionMesh(shape, this.paint, shape.style === "steel" ? COLOURS.steel : colours(shape.at.body)), shape.at.body);
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
      const level = this.data.levels?.columns[shape.coloured_by];
      const mesh = new THREE.Mesh(unitTube(shape.radius), level === undefined ? this.paint(shape.style === "arm" ? colours(shape.a.body) : COLOURS[shape.style] ?? COLOURS.rod) : material(COLOURS.rod));
      if (level !== undefined) this.coloured.push({ mesh, column: columns[level] });
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
    for (const { mesh, column } of this.coloured) rampColour(Math.abs(between(column, spot)) / (this.data.levels.most || 1), mesh.material.color);
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
