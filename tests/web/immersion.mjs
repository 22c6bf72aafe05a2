// The page in virtual reality, in headless Chromium with an emulated headset (npm iwer): a model stands in front of the visitor, turns by the
// stick, is moved by a hand and resized by two, refines when looked at closely, and the page goes on where it was. Without WebXR there is no button.
//
//   node immersion.mjs PICTURES PAGE HIERARCHY
//
// PAGE: the directory that `npm run build` of viewer/ makes, dist/page. Pictures go to the directory PICTURES. Exit code 2: wrong use; else
// see browser.mjs.
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { collectComplaints, comparePictures, frames, inChromium, readHierarchy, until, withoutRestDetail } from './browser.mjs';
import { withSite } from './site.mjs';

const EMULATOR = readFileSync(path.join(path.dirname(fileURLToPath(import.meta.url)), 'node_modules/iwer/build/iwer.min.js'), 'utf8');
const WINDOW = { viewport: { width: 800, height: 500 }, reducedMotion: 'reduce' };

async function open(browser, origin, name, complaints, device) {
  const page = await browser.newPage(WINDOW);
  collectComplaints(page, complaints, ['error']);
  await page.addInitScript(withoutRestDetail);
  if (device !== null) {
    await page.addInitScript(EMULATOR);
    await page.addInitScript((kind) => {
      window.headset = new window.IWER.XRDevice(window.IWER[kind]);
      window.headset.stereoEnabled = true;
      window.headset.installRuntime({ forceInstall: true, polyfillLayers: false });
    }, device);
  }
  await page.goto(`${origin}/index.html#models/${name}.hier`);
  await page.waitForFunction(() => window.meshhier?.settled());
  return page;
}

/// No button is under the pointer.
async function picture(page) {
  await page.mouse.move(10, 490);
  return page.locator('canvas:visible').first().screenshot();
}

/// Once some frames have been drawn.
async function seen(page) {
  await frames(page, 6);
  return picture(page);
}

/// Returns how much of each eye's half is not the ground.
function covered(page, shot) {
  return page.evaluate(async (data) => {
    const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
    context.drawImage(bitmap, 0, 0);
    const { data: pixels, width, height } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    const ground = pixels.slice(0, 3);
    const counts = [0, 0];
    for (let y = 0; y < height; ++y)
      for (let x = 0; x < width; ++x) {
        const at = 4 * (y * width + x);
        if (Math.max(...[0, 1, 2].map((c) => Math.abs(pixels[at + c] - ground[c]))) > 24) ++counts[x < width / 2 ? 0 : 1];
      }
    return counts.map((count) => (2 * count) / (width * height));
  }, shot.toString('base64'));
}

async function checkVr(browser, report, origin, { name }, pictures) {
  const complaints = [];
  const page = await open(browser, origin, name, complaints, 'metaQuest3');
  const button = page.getByRole('button', { name: 'In virtual reality' });
  await button.waitFor();
  const before = await picture(page);
  const camera = await page.evaluate(() => JSON.stringify(window.meshhier.camera()));
  await button.click();
  await page.waitForFunction(() => window.headset.activeSession !== undefined && window.headset.activeSession !== null);
  const first = await seen(page);
  await page.screenshot({ path: path.join(pictures, 'immersion.png') });
  const [left, right] = await covered(page, first);
  report.line('immersion eyes', left > 0.01 && right > 0.01 && Math.abs(left - right) < 0.5 * Math.max(left, right), `the model takes ${(100 * left).toFixed(1)} % and ${(100 * right).toFixed(1)} % of what they see`);
  const rate = await page.evaluate(() => window.meshhier.view.settings.framesPerSecond);
  report.line('immersion rate', rate >= 72, `${rate} frames per second are asked for`);
  await page.evaluate(() => window.headset.controllers.right.updateAxes('thumbstick', 1, 0));
  const turned = await until(page, async () => !first.equals(await seen(page)));
  await page.evaluate(() => window.headset.controllers.right.updateAxes('thumbstick', 0, 0));
  report.line('immersion stick', turned, 'turns the model');
  const still = await seen(page);
  await page.evaluate(() => {
    const { right } = window.headset.controllers;
    right.position.set(0.2, 1.2, -0.4);
    right.updateButtonValue('squeeze', 1);
  });
  await seen(page);
  await page.evaluate(() => window.headset.controllers.right.position.set(0.2, 1.2, 0.2));
  const [was] = await covered(page, still);
  let is = 0;
  const isNearer = await until(page, async () => {
    [is] = await covered(page, await seen(page));
    return is > 1.2 * was;
  });
  await page.evaluate(() => window.headset.controllers.right.updateButtonValue('squeeze', 0));
  report.line('immersion hand', isNearer, `a hand pulls it nearer: ${(100 * was).toFixed(1)} to ${(100 * is).toFixed(1)} %`);
  const level = await page.evaluate(() => window.meshhier.stats().finestLevel);
  // Larger, then at rest: while it moves, as much is drawn as this machine can.
  const refined = await until(page, async () => {
    await page.evaluate(() => window.headset.controllers.right.updateAxes('thumbstick', 0, -1));
    await seen(page);
    await page.evaluate(() => window.headset.controllers.right.updateAxes('thumbstick', 0, 0));
    await page.waitForTimeout(500);
    await seen(page);
    return (await page.evaluate(() => window.meshhier.stats().finestLevel)) > level;
  });
  report.line('immersion refines', refined, `to level ${await page.evaluate(() => window.meshhier.stats().finestLevel)}, from ${level}, as it grows`);
  await page.evaluate(() => window.headset.activeSession.end());
  await page.waitForFunction(() => window.meshhier.settled());
  const same = await until(page, async () => (await comparePictures(page, before, await picture(page))).most <= 2); // bars blur what is behind them
  report.line('immersion ends', same && camera === (await page.evaluate(() => JSON.stringify(window.meshhier.camera()))), 'the page is as it was');
  report.line('immersion console', complaints.length === 0, complaints.join('; ') || 'no errors');
  await page.close();
}

/// In the visitor's own room: the ground shows it.
async function checkAr(browser, report, origin, { name }) {
  const complaints = [];
  const page = await open(browser, origin, name, complaints, 'metaQuest3');
  await page.getByRole('button', { name: 'In your room' }).click();
  const isOn = await until(page, () => page.evaluate(() => window.headset.activeSession?.environmentBlendMode !== undefined));
  const [left] = await covered(page, await seen(page));
  const mode = await page.evaluate(() => window.headset.activeSession.environmentBlendMode);
  await page.evaluate(() => window.headset.activeSession.end());
  await page.waitForFunction(() => window.meshhier.settled());
  report.line('immersion in the room', isOn && left > 0.01 && mode === 'alpha-blend' && complaints.length === 0, `${(100 * left).toFixed(1)} % of the picture, over the room (${mode}); ${complaints.join('; ') || 'no errors'}`);
  await page.close();
}

async function checkWithout(browser, report, origin, { name }) {
  const complaints = [];
  const page = await open(browser, origin, name, complaints, null);
  const buttons = await page.getByRole('button', { name: /reality/ }).count();
  report.line('immersion without a headset', buttons === 0 && complaints.length === 0, 'no button');
  await page.close();
}

async function check(browser, report, [pictures, viewer, directory]) {
  const hierarchy = readHierarchy(directory);
  await withSite(viewer, [hierarchy], async (origin) => {
    await checkVr(browser, report, origin, hierarchy, pictures);
    await checkAr(browser, report, origin, hierarchy);
    await checkWithout(browser, report, origin, hierarchy);
  });
}

const given = process.argv.slice(2);
if (given.length !== 3) {
  console.log('usage: node immersion.mjs PICTURES PAGE HIERARCHY');
  process.exit(2);
}
process.exit(await inChromium(given[0], (browser, report) => check(browser, report, given)));
