// Shows a tileset with CesiumJS, and how its outline differs from that of the partitions.
import { coveredAround, pixelsOf, standing } from './pixels.mjs';

const Cesium = window.Cesium;
/// How many times a tile's error its `geometricError` is, by default.
const PIXELS_AN_ERROR = 16;
// Frames with all tiles there before the picture counts as complete.
const QUIET_FRAMES = 10;

// Frames are drawn when they are asked for: in software those of a large model take seconds.
const widget = new Cesium.CesiumWidget('scene', {
  baseLayer: false,
  skyBox: false,
  skyAtmosphere: false,
  useDefaultRenderLoop: false,
  contextOptions: { webgl: { preserveDrawingBuffer: true } },
});
const { scene } = widget;
scene.backgroundColor = Cesium.Color.BLACK;
scene.globe.show = false;

let tileset = null;
let frame = null;  // axes of the views' directions: the model's, or east, north and up where it is placed
let failures = [];
const outlines = [];

/// Loads a tileset. `placed`: it is on the globe.
async function load({ tileset: url, placed = false }) {
  failures = [];
  tileset = await Cesium.Cesium3DTileset.fromUrl(url, { backFaceCulling: false });
  tileset.tileFailed.addEventListener(({ url: failed, message }) => failures.push(`${failed}: ${message}`));
  scene.primitives.add(tileset);
  const { center } = tileset.boundingSphere;
  frame = placed ? Cesium.Transforms.eastNorthUpToFixedFrame(center) : Cesium.Matrix4.fromTranslation(center);
}

/// Looks from `direction`, `distance` away from `target`, which begins at the middle; both in radii.
function look({ direction, distance, target = [0, 0, 0] }) {
  const { radius } = tileset.boundingSphere;
  const aim = Cesium.Cartesian3.multiplyByScalar(new Cesium.Cartesian3(...target), radius, new Cesium.Cartesian3());
  const from = Cesium.Cartesian3.normalize(new Cesium.Cartesian3(...direction), new Cesium.Cartesian3());
  const offset = Cesium.Cartesian3.multiplyByScalar(from, distance * radius, new Cesium.Cartesian3());
  scene.camera.frustum.near = 0.001 * radius;
  scene.camera.frustum.far = 100 * radius;
  const around = Cesium.Matrix4.multiplyByTranslation(frame, aim, new Cesium.Matrix4());
  scene.camera.lookAtTransform(around, offset);
  // Light from over the viewer's right shoulder.
  const { directionWC, rightWC, upWC } = scene.camera;
  const light = Cesium.Cartesian3.clone(directionWC);
  for (const side of [rightWC, upWC]) {
    Cesium.Cartesian3.subtract(light, Cesium.Cartesian3.multiplyByScalar(side, 0.4, new Cesium.Cartesian3()), light);
  }
  scene.light = new Cesium.DirectionalLight({ direction: light });
}

function draw() {
  widget.resize();
  widget.render();
}

/// Refines until nothing is left to do for `errorTarget` pixels.
async function settle(errorTarget) {
  tileset.maximumScreenSpaceError = PIXELS_AN_ERROR * errorTarget;
  for (let quiet = 0; quiet < QUIET_FRAMES; ) {
    await new Promise((resolve) => requestAnimationFrame(resolve));
    draw();
    quiet = tileset.tilesLoaded ? quiet + 1 : 0;
  }
  const names = new Set();
  const note = (tile) => names.add(new URL(tile.content.url, location.href).pathname);
  tileset.tileVisible.addEventListener(note);
  draw();
  tileset.tileVisible.removeEventListener(note);
  return { visible: [...names].sort(), failures };
}

/// Returns what is covered now, and its pixels.
function picture() {
  draw();
  const { canvas } = scene;
  const pixels = pixelsOf(canvas);
  const covered = new Uint8Array(canvas.width * canvas.height);
  for (let i = 0; i < covered.length; ++i) {
    covered[i] = pixels[4 * i] > 5 || pixels[4 * i + 1] > 5 || pixels[4 * i + 2] > 5 ? 1 : 0;
  }
  return { covered, width: canvas.width, pixels };
}

/// Keeps what is covered now.
function keepOutline() {
  const { covered, width } = picture();
  outlines.push({ covered, width });
}

/// How the outline kept first differs from that kept last; holes as three_page.mjs has them.
function compare(errorTarget) {
  const [ours, theirs] = [outlines.at(0), outlines.at(-1)];
  const reach = Math.ceil(errorTarget) + 1;
  let covered = 0, outline = 0, holes = 0;
  for (let i = 0; i < ours.covered.length; ++i) {
    covered += theirs.covered[i];
    if (ours.covered[i] !== theirs.covered[i]) ++outline;
    if (!ours.covered[i] && coveredAround(theirs, i, reach)) ++holes;
  }
  outlines.length = 0;
  return { covered, outline: outline / covered, holes };
}

/// Tells what stands in the picture (pixels.mjs).
function stand() {
  const { covered, width, pixels } = picture();
  return standing({ covered, width }, pixels);
}

/// Where the model's middle is on the globe, in degrees and metres.
function place() {
  const { center, radius } = tileset.boundingSphere;
  const { longitude, latitude, height } = Cesium.Cartographic.fromCartesian(center);
  return {
    longitude: Cesium.Math.toDegrees(longitude),
    latitude: Cesium.Math.toDegrees(latitude),
    height,
    radius,
  };
}

/// Shows or hides the globe: an ellipsoid of one colour.
async function showGlobe(show) {
  scene.globe.show = show;
  scene.globe.baseColor = Cesium.Color.DARKSLATEGRAY;
  do {
    await new Promise((resolve) => requestAnimationFrame(resolve));
    draw();
  } while (show && !scene.globe.tilesLoaded);
}

function raysThrough(places) {
  return places.map(([x, y]) => {
    const { origin, direction } = scene.camera.getPickRay(new Cesium.Cartesian2(x, y));
    return { from: [origin.x, origin.y, origin.z], direction: [direction.x, direction.y, direction.z] };
  });
}

/// Returns the properties of the things at places of the picture; null where nothing is.
function pickAll(places) {
  return places.map(([x, y]) => {
    const feature = scene.pick(new Cesium.Cartesian2(x, y), 1, 1);
    return feature?.getPropertyIds ? Object.fromEntries(feature.getPropertyIds().map((id) => [id, feature.getProperty(id)])) : null;
  });
}

/// Shows the tileset's colours without light from now on.
function showColours() {
  tileset.customShader = new Cesium.CustomShader({ lightingModel: Cesium.LightingModel.UNLIT });
}

window.view = { showColours, raysThrough, pickAll, load, look, settle, keepOutline, compare, stand, place, showGlobe };
