// Shows hierarchies of the textured or coloured square (textured_square.mjs) in all viewers, in headless Chromium: each of its corners
// has the colour of the picture or of its vertices, unlit, and is where it belongs. The page of viewer/ lights vertices' colours: there
// hierarchies with such colours look the same, wherever their colours come from.
//
//   node textures.mjs PICTURES PAGE HIERARCHY...
//
// PAGE: of viewer/, dist/page. Pictures go to the directory PICTURES. Exit code 2: wrong use; else see browser.mjs.
import path from 'node:path';
import { call, decodePicture, frames, inChromium, loseDevice, readHierarchy, SIZE, withPage } from './browser.mjs';
import { withSite } from './site.mjs';
import { CORNERS } from './textured_square.mjs';

/// From the picture's middle to where a corner's colour is looked up: in each viewer the square is more than twice as large.
const OFFSET = 45;
const REACH = 8;
/// Lossy coders and the arithmetic of viewers may change a colour by so much, of 255.
const TOLERANCE = 4;
/// In viewers whose camera stands elsewhere: part of what is covered that has one of the four colours.
const LEAST_FLAT = 0.9;
const COARSE = 4; // pixels of error: CesiumJS shows nothing of a tileset that has less
const EXACT = 1e-6;

function far(pixels, i, colour) {
  return Math.max(...colour.map((value, k) => Math.abs(value - pixels[4 * i + k])));
}

/// The largest difference from the corner's colour around its place.
function differenceAt(pixels, { right, up, colour }) {
  const [x, y] = [SIZE / 2 + right * OFFSET, SIZE / 2 - up * OFFSET];
  let most = 0;
  for (let dy = -REACH; dy <= REACH; ++dy)
    for (let dx = -REACH; dx <= REACH; ++dx) most = Math.max(most, far(pixels, (y + dy) * SIZE + x + dx, colour));
  return most;
}

function judgeCorners(report, what, pixels, tiles) {
  const differences = CORNERS.map((corner) => differenceAt(pixels, corner));
  const text = CORNERS.map(({ name }, i) => `${name} ${differences[i]}`).join(', ');
  report.line(what, tiles > 0 && differences.every((most) => most <= TOLERANCE), `${tiles} tiles; off by ${text}`);
}

/// Where nobody says from where the square is seen.
function judgeColours(report, what, pixels) {
  const covered = [...Array(SIZE * SIZE).keys()].filter((i) => pixels[4 * i] + pixels[4 * i + 1] + pixels[4 * i + 2] > 15);
  const parts = CORNERS.map(({ colour }) => covered.filter((i) => far(pixels, i, colour) <= TOLERANCE).length / covered.length);
  const flat = parts.reduce((sum, part) => sum + part, 0);
  report.line(what, flat >= LEAST_FLAT && Math.min(...parts) > 0.05, `of what is covered ${parts.map((part) => `${(100 * part).toFixed(1)} %`).join(', ')} have the corners' colours`);
}

let firstLit = null;

/// Under one light the corners of all squares look the same.
function judgeLit(report, what, pixels) {
  const seen = CORNERS.map(({ right, up }) => {
    const i = 4 * ((SIZE / 2 - up * OFFSET) * SIZE + SIZE / 2 + right * OFFSET);
    return [...pixels.slice(i, i + 3)];
  });
  firstLit ??= seen;
  const most = Math.max(...seen.map((colour, i) => Math.max(...colour.map((value, c) => Math.abs(value - firstLit[i][c])))));
  const apart = Math.max(...seen[0].map((value, c) => Math.abs(value - seen[2][c])));
  report.line(what, most <= TOLERANCE && apart > 3 * TOLERANCE, `corners ${seen.map((colour) => colour.join(' ')).join(', ')}; off by ${most}`);
}

async function showTileset(page, decoder, { viewer, name, isTextured, pictures, report }) {
  await call(page, 'load', { tileset: '/hierarchy/tileset.json' });
  if (!isTextured) await call(page, 'showColours');
  await call(page, 'look', { direction: [0, -1, 0], distance: 3 });
  for (const [what, error] of [['coarse', COARSE], ['exact', EXACT]]) {
    const { visible, failures } = await call(page, 'settle', error);
    const picture = await page.screenshot({ path: path.join(pictures, `${name}-${viewer}-${what}.png`) });
    judgeCorners(report, `${name} ${viewer} ${what}`, await decodePicture(decoder, picture), failures.length === 0 ? visible.length : 0);
  }
}

async function showTile(page, decoder, { name, isTextured, pictures, report }) {
  await call(page, 'load', '/hierarchy/tiles/00/000000.glb');
  if (!isTextured) await call(page, 'showColours');
  const picture = await page.screenshot({ path: path.join(pictures, `${name}-babylon.png`) });
  judgeColours(report, `${name} babylon root`, await decodePicture(decoder, picture));
}

async function settled(page) {
  await frames(page); // keys and settings have come to one
  await page.waitForFunction(() => window.meshhier?.settled());
}

async function showInPage(browser, decoder, pagePath, hierarchy, { pictures, report }) {
  await withSite(pagePath, [hierarchy], async (origin) => {
    const page = await browser.newPage({ viewport: { width: SIZE, height: SIZE }, reducedMotion: 'reduce' });
    await page.goto(`${origin}/index.html#models/${hierarchy.name}.hier`);
    await settled(page);
    await page.evaluate(() => { window.meshhier.setCamera({ position: [0, 0, 4], target: [0, 0, 0] }); });
    if (!hierarchy.isTextured) {
      await settled(page);
      const picture = await page.screenshot({ path: path.join(pictures, `${hierarchy.name}-page.png`) });
      judgeLit(report, `${hierarchy.name} page`, await decodePicture(decoder, picture));
      await page.close();
      return;
    }
    for (const [what, threshold] of [['root', 1000], ['exact', 0.01]]) {
      await page.evaluate((pixels) => { window.meshhier.view.setSettings({ threshold: pixels }); }, threshold);
      await settled(page);
      const picture = await page.screenshot({ path: path.join(pictures, `${hierarchy.name}-page-${what}.png`) });
      const { tiles } = await page.evaluate(() => window.meshhier.stats());
      judgeCorners(report, `${hierarchy.name} page ${what}`, await decodePicture(decoder, picture), tiles);
    }
    await loseDevice(page);
    await settled(page);
    const { tiles, fetchedFiles } = await page.evaluate(() => window.meshhier.stats());
    const again = await decodePicture(decoder, await page.screenshot());
    judgeCorners(report, `${hierarchy.name} page with the device lost and back, ${fetchedFiles} files`, again, tiles);
    await page.keyboard.press('t');
    await settled(page);
    const plain = await decodePicture(decoder, await page.screenshot());
    report.line(`${hierarchy.name} page without texture`, CORNERS.every((corner) => differenceAt(plain, corner) > 3 * TOLERANCE), 'no corner has its colour');
    await page.close();
  });
}

async function showAll(browser, report, pictures, pagePath, hierarchies) {
  const decoder = await browser.newPage();
  for (const hierarchy of hierarchies.map(readHierarchy)) {
    const { name, directory, isTextured } = hierarchy;
    const isKtx2 = hierarchy.pictureFormat === 'ktx2';
    if (isKtx2) console.log(`skipped  ${name} babylon: its transcoder of KTX2 comes from a host of its makers`);
    for (const [viewer, show] of [['three', showTileset], ['cesium', showTileset], ...(isKtx2 ? [] : [['babylon', showTile]])])
      await withPage(browser, report, { viewer, name, directories: { '/hierarchy': directory } }, (page) =>
        show(page, decoder, { viewer, name, isTextured, pictures, report }));
    await showInPage(browser, decoder, pagePath, hierarchy, { pictures, report });
  }
}

const [pictures, pagePath, ...hierarchies] = process.argv.slice(2);
if (hierarchies.length === 0) {
  console.log('usage: node textures.mjs PICTURES PAGE HIERARCHY...');
  process.exit(2);
}
process.exit(await inChromium(pictures, (browser, report) => showAll(browser, report, pictures, pagePath, hierarchies)));
