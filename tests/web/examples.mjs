// The pages of examples/, with the models of a `meshhier serve --cors` of another origin, in headless Chromium: each shows its
// model lit, whole and in the middle, and says what is wrong where there is none.
//
//   node examples.mjs MESHHIER PICTURES MODELS NAME...
//
// MODELS: a directory that may be written to; NAME.hier: a hierarchy in it; plain.hier, without compression, is the one that engine.html
// shows. Pictures go to the directory PICTURES. Exit code 2: wrong use; else see browser.mjs.
import { cpSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { collectComplaints, decodePicture, inChromium, SIZE, until } from './browser.mjs';
import { startServer } from './meshhier_server.mjs';
import { serve } from './server.mjs';

const HERE = path.dirname(fileURLToPath(import.meta.url));
const ROOT = path.join(HERE, '../..');
const PAGES = ['cesium', '3d-tiles-renderer', 'three', 'element', 'engine'];
const DAMAGED = 'damaged.hier';
const BACKGROUND = [0x1c, 0x25, 0x30]; // of example.css
/// The page that reads tiles itself, and takes them without meshopt alone.
const OWN_READER = 'engine';
const PLAIN = 'plain';
/// Parts of the picture that the model covers at least and at most.
const COVERED = [0.05, 0.8];
/// The 5th and the 95th percentile of the covered pixels' brightness (0 to 255) are so far apart at least. A silhouette has 0.
const LEAST_CONTRAST = 40;
/// How far the middle of what is covered may be from the picture's, in parts of its size.
const OFF_CENTRE = 0.1;

/// The pages with their packages, as `npm install` and `npm run build` put them there.
function servePages() {
  return serve({
    '/examples/node_modules/meshoptimizer': path.join(ROOT, 'viewer/node_modules/meshoptimizer'),
    '/examples/node_modules': path.join(HERE, 'node_modules'),
    '/examples': path.join(ROOT, 'examples'),
    '/viewer/dist': path.join(ROOT, 'viewer/dist'),
  });
}

/// Users must install what is tested here.
function checkVersions(report) {
  const versionsOf = (file) => JSON.parse(readFileSync(path.join(ROOT, file), 'utf8')).dependencies;
  const tested = { ...versionsOf('tests/web/package.json'), ...versionsOf('viewer/package.json') };
  const others = Object.entries(versionsOf('examples/package.json')).filter(([name, version]) => tested[name] !== version);
  report.line('examples packages', others.length === 0, others.map(([name, version]) => `${name} ${version} is not the tested ${tested[name]}`).join('; ') || 'of the tested versions');
}

/// Tells what is not background: which part of the picture, how far from its middle, whether it reaches the edge, and its contrast.
function measure(pixels) {
  const places = [...Array(SIZE * SIZE).keys()].filter((i) => BACKGROUND.some((value, k) => Math.abs(pixels[4 * i + k] - value) > 8));
  const [xs, ys] = [places.map((i) => i % SIZE), places.map((i) => Math.floor(i / SIZE))];
  const [left, right, top, bottom] = [xs, ys].flatMap((all) => [all.reduce((a, b) => Math.min(a, b), SIZE), all.reduce((a, b) => Math.max(a, b), 0)]);
  const brightness = places.map((i) => (pixels[4 * i] + pixels[4 * i + 1] + pixels[4 * i + 2]) / 3).sort((a, b) => a - b);
  const percentile = (part) => brightness[Math.floor(part * (brightness.length - 1))] ?? 0;
  return {
    covered: places.length / (SIZE * SIZE),
    offCentre: Math.max(Math.abs(left + right + 1 - SIZE), Math.abs(top + bottom + 1 - SIZE)) / 2 / SIZE,
    isWhole: left > 0 && top > 0 && right < SIZE - 1 && bottom < SIZE - 1,
    contrast: percentile(0.95) - percentile(0.05),
  };
}

/// The picture once it shows something and no longer changes.
async function settledPicture(page, decoder) {
  let [last, same] = [null, 0];
  await until(page, async () => {
    await page.waitForTimeout(250);
    const picture = await page.screenshot();
    same = last?.equals(picture) ? same + 1 : 0;
    last = picture;
    return same >= 4 && measure(await decodePicture(decoder, picture)).covered > 0;
  });
  return last;
}

async function openPage(browser, address, complaints) {
  const page = await browser.newPage({ viewport: { width: SIZE, height: SIZE } });
  collectComplaints(page, complaints);
  await page.goto(address);
  return page;
}

async function checkPicture(browser, report, { decoder, pages, models, pictures }, viewer, name) {
  const complaints = [];
  const page = await openPage(browser, `${pages}/examples/${viewer}.html?url=${models}models/${name}.hier`, complaints);
  await page.addStyleTag({ content: '.cesium-widget-credits { display: none }' }); // no part of the model
  const picture = await settledPicture(page, decoder);
  const message = await page.locator('#message').innerText();
  await page.screenshot({ path: path.join(pictures, `example-${viewer}-${name}.png`) });
  await page.close();
  const { covered, offCentre, isWhole, contrast } = measure(await decodePicture(decoder, picture));
  const isGood = covered >= COVERED[0] && covered <= COVERED[1] && isWhole && offCentre <= OFF_CENTRE && contrast >= LEAST_CONTRAST;
  report.line(`examples ${viewer} ${name}`, isGood && message === '' && complaints.length === 0,
    `covers ${(100 * covered).toFixed(1)} %, ${isWhole ? 'whole' : 'CUT OFF'}, ${(100 * offCentre).toFixed(1)} % off the middle, contrast ${contrast.toFixed(0)} ${[message, ...complaints].join(' ')}`);
}

/// The page must say `text` if it is asked for `query`.
async function checkMessage(browser, report, pages, viewer, [what, query, text]) {
  const page = await openPage(browser, `${pages}/examples/${viewer}.html${query}`, []);
  const message = page.locator('#message', { hasText: text });
  const isSaid = await message.waitFor().then(() => true, () => false);
  report.line(`examples ${viewer} ${what}`, isSaid, await page.locator('#message').innerText());
  await page.close();
}

async function checkAll(browser, report, { pages, models, closed, names, pictures }) {
  const decoder = await browser.newPage();
  const troubles = [
    ['without a URL', '', 'Which hierarchy?'],
    ['without a hierarchy', `?url=${models}models/none.hier`, 'There is no hierarchy at'],
    ['damaged', `?url=${models}models/${DAMAGED}`, 'cannot be shown'],
    ['without --cors', `?url=${closed}models/${names[0]}.hier`, 'was it started with --cors?'],
  ];
  for (const viewer of PAGES) {
    for (const name of viewer === OWN_READER ? [PLAIN] : names) await checkPicture(browser, report, { decoder, pages, models, pictures }, viewer, name);
    for (const trouble of troubles) await checkMessage(browser, report, pages, viewer, trouble);
  }
  await checkMessage(browser, report, pages, 'cesium', ['without a place', `?url=${models}models/${PLAIN}.hier&globe`, 'has no place on the globe']);
}

/// A copy of a hierarchy whose root tile is none.
function makeDamaged(folder, name) {
  cpSync(path.join(folder, `${name}.hier`), path.join(folder, DAMAGED), { recursive: true });
  writeFileSync(path.join(folder, DAMAGED, 'tiles/00/000000.glb'), 'no tile');
}

async function withServers(meshhier, folder, use) {
  const pages = await servePages();
  const servers = [startServer(meshhier, folder, '--cors', pages.origin), startServer(meshhier, folder)];
  try {
    const [models, closed] = await Promise.all(servers.map(({ url }) => url));
    await use({ pages: pages.origin, models, closed });
  } finally {
    await Promise.all(servers.map((server) => server.stop()));
    pages.close();
    rmSync(path.join(folder, DAMAGED), { recursive: true });
  }
}

const [meshhier, pictures, folder, ...names] = process.argv.slice(2);
if (names.length === 0) {
  console.log('usage: node examples.mjs MESHHIER PICTURES MODELS NAME...');
  process.exit(2);
}
process.exit(await inChromium(pictures, async (browser, report) => {
  checkVersions(report);
  makeDamaged(folder, names[0]);
  await withServers(meshhier, folder, (places) => checkAll(browser, report, { ...places, names, pictures }));
}));
