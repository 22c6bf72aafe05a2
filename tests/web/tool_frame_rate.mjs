// Whether viewer/'s page holds 60 frames a second while tools are in use: in headless Chromium, by a clock that stands for a device.
//
//   node tool_frame_rate.mjs PICTURES PAGE HIERARCHY
//
// Each frame takes a fixed time and more for each triangle that WebGL is given, those that caps of a section take too; tiles that were asked
// for are there by the next one. The device could show half of what a view at rest shows. PAGE: the directory that `npm run build` of viewer/ makes, dist/page. The hierarchy
// must be closed, of many tiles. Exit code 2: wrong use; else see browser.mjs.
import path from 'node:path';
import { collectComplaints, inChromium, readHierarchy } from './browser.mjs';
import { withSite } from './site.mjs';

const RATE = 60;
const BASE = 4; // milliseconds a frame takes without a triangle
const SECONDS = 5;
const SETTLE_SECONDS = 2;
const WINDOW = 10; // frames

/// Runs in the page before its own scripts: `window.device`, and callbacks of requestAnimationFrame by its clock.
function simulateDevice() {
  const TRIANGLES = 4; // the primitive
  const device = { clock: 0, triangles: 0, lastTriangles: 0, perTriangle: null, base: 0, frames: [], move: null };
  window.device = device;
  const { prototype } = WebGL2RenderingContext;
  for (const [name, place] of [['drawElements', 1], ['drawArrays', 2]]) {
    const draw = prototype[name];
    prototype[name] = function counted(...given) {
      if (given[0] === TRIANGLES) device.triangles += given[place] / 3;
      return draw.apply(this, given);
    };
  }
  const request = window.requestAnimationFrame.bind(window);
  let last = 0;
  let isHeld = false; // until tiles have come
  const waiting = new Set();
  const tick = (now) => {
    request(tick); // ahead of all others in the next frame
    isHeld = device.perTriangle !== null && window.meshhier.view.stats().pending > 0;
    if (isHeld) return;
    const { triangles } = device;
    const took = device.perTriangle === null ? now - last : device.base + triangles * device.perTriangle;
    last = now;
    device.clock += took;
    if (triangles > 0) device.lastTriangles = triangles;
    if (device.perTriangle !== null) device.frames.push({ at: device.clock, took, triangles });
    device.triangles = 0;
    device.move?.(device.clock);
  };
  request(tick);
  window.requestAnimationFrame = (callback) => {
    const wait = () => {
      if (isHeld) request(wait);
      else if (waiting.delete(id)) callback(device.clock);
    };
    const id = request(wait);
    waiting.add(id);
    return id;
  };
  window.cancelAnimationFrame = (id) => { waiting.delete(id); };
}

function settle(page) {
  return page.waitForFunction(() => window.meshhier?.settled());
}

/// Looks at the model from around it, so near that it fills the picture.
function lookFrom(page, angle) {
  return page.evaluate((at) => {
    window.lookFrom ??= (turn) => {
      const { min, max } = window.meshhier.view.box;
      const middle = ['x', 'y', 'z'].map((axis) => (min[axis] + max[axis]) / 2);
      const reach = 0.6 * Math.hypot(max.x - min.x, max.y - min.y, max.z - min.z);
      const away = [Math.cos(turn), 0.4, Math.sin(turn)];
      window.meshhier.setCamera({ position: middle.map((value, axis) => value + reach * away[axis]), target: middle });
    };
    window.lookFrom(at);
  }, angle);
}

/// `plain`: triangles that are drawn without tools.
async function useTools(page, plain) {
  const { width, height } = page.viewportSize();
  await page.keyboard.press('m');
  await page.locator('.tool-card', { hasText: 'Measure' }).waitFor();
  for (const part of [0.3, 0.7]) await page.mouse.click(part * width, 0.5 * height);
  await page.locator('.surface').focus();
  await page.keyboard.press('x');
  await page.locator('.tool-card', { hasText: 'Cut open' }).waitFor();
  await page.waitForFunction((least) => window.meshhier.settled() && window.device.lastTriangles > least, plain);
}

/// Means of the frames' rates, some frames at a time.
function ratesOf(frames) {
  const rates = [];
  for (let i = 0; i + WINDOW <= frames.length; i += WINDOW)
    rates.push((1000 * WINDOW) / frames.slice(i, i + WINDOW).reduce((sum, { took }) => sum + took, 0));
  return rates;
}

async function circle(page) {
  await page.evaluate(([rate, base]) => {
    const { device } = window;
    device.began = device.clock;
    device.base = base;
    device.perTriangle = (1000 / rate - base) / (0.5 * device.lastTriangles);
    device.move = (clock) => { window.lookFrom((clock - device.began) / 4000); };
  }, [RATE, BASE]);
  for (let second = 1; second <= SECONDS; ++second) await page.waitForFunction((seconds) => window.device.clock - window.device.began > 1000 * seconds, second, { polling: 100 });
  return page.evaluate(() => {
    window.device.move = null;
    return window.device.frames.map(({ at, ...frame }) => ({ at: at - window.device.began, ...frame }));
  });
}

async function check(browser, report, { pictures, origin, name }) {
  const page = await browser.newPage({ viewport: { width: 480, height: 360 }, reducedMotion: 'reduce' });
  const complaints = [];
  collectComplaints(page, complaints);
  await page.addInitScript(simulateDevice);
  await page.goto(`${origin}/index.html#models/${name}.hier`);
  await settle(page);
  await page.evaluate((framesPerSecond) => { window.meshhier.view.setSettings({ framesPerSecond }); }, RATE);
  await lookFrom(page, 0);
  await settle(page);
  const plain = await page.evaluate(() => window.device.lastTriangles);
  await useTools(page, plain);
  const full = await page.evaluate(() => window.device.lastTriangles);
  const frames = await circle(page);
  const late = frames.filter(({ at }) => at >= 1000 * SETTLE_SECONDS);
  const rates = ratesOf(late);
  const good = rates.length > 0 && rates.every((rate) => Math.abs(rate / RATE - 1) <= 0.15);
  report.line(`${name} frame rate with tools`, good && complaints.length === 0,
    `${Math.min(...rates).toFixed(1)} … ${Math.max(...rates).toFixed(1)} frames a second after ${SETTLE_SECONDS} s (asked for: ${RATE}); at rest ${full} triangles are drawn, ` +
      `without tools ${plain}, on the way ${late.at(-1)?.triangles}; ${complaints.join('; ') || 'no complaints'}`);
  await page.screenshot({ path: path.join(pictures, `tool-frame-rate-${name}.png`) });
  await page.close();
}

const given = process.argv.slice(2);
if (given.length !== 3) {
  console.log('usage: node tool_frame_rate.mjs PICTURES PAGE HIERARCHY');
  process.exit(2);
}
const [pictures, site, directory] = given;
const { name } = readHierarchy(directory);
process.exit(await inChromium(pictures, (browser, report) =>
  withSite(site, [readHierarchy(directory)], (origin) => check(browser, report, { pictures, origin, name }))));
