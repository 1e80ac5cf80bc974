// What stands still: floor, road, track, cones, paths.

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
