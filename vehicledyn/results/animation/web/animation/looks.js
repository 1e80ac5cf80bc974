// Colours and materials, on light and on dark ground.

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

// Colours from nothing to the highest value (viridis), told apart in grey too.
const RAMP = [0x440154, 0x3b528b, 0x21918c, 0x5ec962, 0xfde725].map((colour) => new THREE.Color(colour));

function rampColour(part, out) {
  if (!Number.isFinite(part)) return out.set(0x808080);
  const place = Math.min(Math.max(part, 0), 1) * (RAMP.length - 1), k = Math.min(Math.floor(place), RAMP.length - 2);
  return out.copy(RAMP[k]).lerp(RAMP[k + 1], place - k);
}

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
