// A short text in the 3-D view that faces whoever looks and is as large wherever the camera is, seen through everything.

const [HEIGHT, MARGIN] = [48, 8]; // [px] of the drawing
const FONT = `bold ${HEIGHT - 2 * MARGIN}px sans-serif`;

/**
 * @param {string} text
 * @param {{color?: string, sizeAttenuation?: boolean}} style
 */
export function textSprite(text, { color = "#fff", sizeAttenuation = false } = {}) {
  const { THREE } = globalThis.MeshCat;
  const canvas = document.createElement("canvas");
  const pen = canvas.getContext("2d");
  if (pen) write(canvas, pen, text, color);
  const map = new THREE.CanvasTexture(canvas);
  map.minFilter = THREE.LinearFilter; // its size is no power of two
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({ map, depthTest: false, sizeAttenuation }));
  sprite.scale.set(canvas.width / canvas.height, 1, 1);
  sprite.renderOrder = 5;
  return sprite;
}

/** @param {HTMLCanvasElement} canvas @param {CanvasRenderingContext2D} pen @param {string} text @param {string} color */
function write(canvas, pen, text, color) {
  pen.font = FONT;
  const width = Math.ceil(pen.measureText(text).width) + 2 * MARGIN;
  Object.assign(canvas, { width, height: HEIGHT }); // which resets the pen
  Object.assign(pen, { font: FONT, textAlign: "center", textBaseline: "middle", lineJoin: "round", lineWidth: 8 });
  Object.assign(pen, { strokeStyle: "rgb(0 0 0 / 0.7)", fillStyle: color });
  pen.strokeText(text, width / 2, HEIGHT / 2);
  pen.fillText(text, width / 2, HEIGHT / 2);
}
