// Bodies of what is shown: wheels, hulls, boxes, coils, arrows, swept sections.

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
  return blockMesh(new THREE.BoxGeometry(...shape.size), shape, paint, colour);
}

// A profile in the plane of x and z, drawn along y.
function extrusionMesh(shape, paint, colour) {
  const profile = new THREE.Shape(shape.profile.map(([x, z]) => new THREE.Vector2(x, z)));
  const geometry = new THREE.ExtrudeGeometry(profile, { depth: shape.width, bevelEnabled: false });
  geometry.translate(0, 0, -0.5 * shape.width).rotateX(Math.PI / 2);
  return blockMesh(geometry, shape, paint, colour);
}

function blockMesh(geometry, shape, paint, colour) {
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
