// The four modes of the page of viewer/ on several models, on a desktop and on a phone, from the gallery down to the
// original triangles: pictures, without a complaint on the console.
//
//   node modes.mjs PICTURES PAGE HIERARCHY...
//
// PAGE: the directory that `npm run build` of viewer/ makes. The way down through the first model is kept as a strip of pictures.
// Exit code 2: wrong use; else see browser.mjs.
import path from 'node:path';
import { collectComplaints, inChromium, readHierarchy } from './browser.mjs';
import { withSite } from './site.mjs';

const SCREENS = {
  desktop: { viewport: { width: 1280, height: 800 } },
  phone: { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true },
};
const MOST_STEPS = 30;
/// A model of fewer triangles shows the original ones wherever a view of a part of it rests: ZSV on the way only.
const RESTS_COARSER = 80_000;

function settle(page) {
  return page.waitForFunction(() => window.meshhier.settled());
}

function modeOf(page) {
  return page.evaluate(() => window.meshhier.stats()?.mode ?? 'TP');
}

/// Remembers each picture's mode, of those on the way too.
function watchModes(page) {
  return page.addInitScript(() => {
    window.modesShown = new Set();
    const look = () => {
      const mode = window.meshhier?.stats()?.mode;
      if (mode !== undefined) window.modesShown.add(mode);
      requestAnimationFrame(look);
    };
    look();
  });
}

/// Parts of the picture's width and height where the model may be hit: first the middle.
const PLACES = [[0.5, 0.5], [0.5, 0.6], [0.56, 0.5], [0.44, 0.5], [0.5, 0.42], [0.6, 0.58], [0.4, 0.58], [0.5, 0.66]];

function cameraOf(page) {
  return page.evaluate(() => JSON.stringify(window.meshhier.camera()));
}

/// A double click where the model is.
async function closer(page) {
  const { width, height } = page.viewportSize();
  const before = await cameraOf(page);
  for (const [x, y] of PLACES) {
    await page.mouse.dblclick(x * width, y * height);
    await page.evaluate(() => new Promise((resolve) => { requestAnimationFrame(() => requestAnimationFrame(resolve)); }));
    if ((await cameraOf(page)) !== before) return;
  }
}

/// A notch of the wheel.
async function bitCloser(page) {
  const { width, height } = page.viewportSize();
  const before = await cameraOf(page);
  await page.mouse.move(0.5 * width, 0.5 * height);
  await page.mouse.wheel(0, -200);
  await page.waitForFunction((camera) => JSON.stringify(window.meshhier.camera()) !== camera, before);
}

/// Down to the surface in the middle of the picture; each mode's first settled picture is kept. As long as all of the model is in view,
/// in small steps: a double click from there may end where all that is seen is original. The modes in which a view rested.
async function goDown(page, keep) {
  const seen = new Set();
  for (let step = 0; step < MOST_STEPS && !seen.has('DZM'); ++step) {
    await settle(page);
    const mode = await modeOf(page);
    await keep(mode, step, !seen.has(mode));
    seen.add(mode);
    await (mode === 'CWV' ? bitCloser : closer)(page);
  }
  return seen;
}

async function visit(browser, report, { origin, pictures, screen, name, triangles, isFirst }) {
  const strip = isFirst && screen === 'desktop';
  const page = await browser.newPage({ reducedMotion: 'reduce', ...SCREENS[screen] });
  await watchModes(page);
  const complaints = [];
  collectComplaints(page, complaints, ['error', 'warning']);
  const shoot = (what) => page.screenshot({ path: path.join(pictures, `${what}.png`) });
  await page.goto(`${origin}/index.html`);
  await page.waitForFunction(() => document.querySelector('a.cell') !== null && document.querySelector('.cell-stage.waiting') === null);
  await page.waitForLoadState('networkidle');
  await page.waitForFunction(() => document.querySelector('.cell-stage.waiting') === null);
  if (isFirst) await shoot(`modes-${screen}-TP`);
  if (strip) await shoot('strip-00-TP');
  await page.locator('a.cell', { has: page.getByText(name, { exact: true }) }).click();
  const rested = await goDown(page, async (mode, step, isNew) => {
    if (isNew) await shoot(`modes-${screen}-${name}-${mode}`);
    if (strip) await shoot(`strip-${String(step + 1).padStart(2, '0')}-${mode}`);
  });
  const stats = await page.evaluate(() => window.meshhier.stats());
  const shown = await page.evaluate(() => [...window.modesShown]);
  await page.keyboard.press('w');
  await page.keyboard.press('p');
  await settle(page);
  await shoot(`modes-${screen}-${name}-DZM-wires`);
  const isIn = (mode) => rested.has(mode) || (mode === 'ZSV' && triangles < RESTS_COARSER && shown.includes(mode));
  const good = ['CWV', 'ZSV', 'DZM'].every(isIn) && complaints.length === 0;
  report.line(`modes ${screen} ${name}`, good,
    `${['TP', ...shown].join(' ')}; ${stats.fetchedFiles} tiles, ${stats.fetchedBytes} bytes, ${stats.savedBytes} saved; ${complaints.join('; ') || 'no complaints'}`);
  await page.close();
}

async function visitAll(browser, report, [pictures, page, ...directories]) {
  const hierarchies = directories.map(readHierarchy);
  await withSite(page, hierarchies, async (origin) => {
    for (const screen of Object.keys(SCREENS))
      for (const [index, { name, triangles }] of hierarchies.entries())
        await visit(browser, report, { origin, pictures, screen, name, triangles, isFirst: index === 0 });
  });
}

const [pictures, ...others] = process.argv.slice(2);
if (others.length < 2) {
  console.log('usage: node modes.mjs PICTURES PAGE HIERARCHY...');
  process.exit(2);
}
process.exit(await inChromium(pictures, (browser, report) => visitAll(browser, report, [pictures, ...others])));
