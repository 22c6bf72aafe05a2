// The page of viewer/ on a slow device behind a slow line: when the first picture is there, and what it and the
// finished view take.
//
//   node first_picture.mjs PICTURES PAGE HIERARCHY...
//
// PAGE: the directory that `npm run build` of viewer/ makes. Times are told and decide nothing; requests do. Exit code 2: wrong
// use; else see browser.mjs.
import path from 'node:path';
import { inChromium, readHierarchy, SLOW_LINE } from './browser.mjs';
import { serve } from './server.mjs';

const SLOWDOWN = 4;
const PHONE = { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true };
const PATIENCE = 600_000; // milliseconds
const FIRST_PICTURE = 'meshhier: first picture';

/// The page on a slow device, and each tile that it asks for with the time it took.
async function openSlowly(browser, url) {
  const page = await browser.newPage({ reducedMotion: 'reduce', ...PHONE });
  const session = await page.context().newCDPSession(page);
  await session.send('Network.enable');
  await session.send('Network.emulateNetworkConditions', SLOW_LINE);
  await session.send('Emulation.setCPUThrottlingRate', { rate: SLOWDOWN });
  const tiles = [];
  let bytes = 0;
  page.on('request', (request) => request.url().includes('/tiles/') && tiles.push(request.url()));
  session.on('Network.dataReceived', ({ encodedDataLength }) => (bytes += encodedDataLength)); // of files that are still coming, too
  await page.goto(url);
  return { page, tiles, bytes: () => bytes };
}

/// Milliseconds of the page's own clock; how many tiles were asked for before the first picture.
function times(page) {
  return page.evaluate((name) => {
    const scripts = performance.getEntriesByType('resource').filter((entry) => /assets\/(index|model_view)[^/]*\.js$/.test(entry.name));
    const picture = performance.getEntriesByName(name)[0].startTime;
    const tiles = performance.getEntriesByType('resource').filter((entry) => entry.name.includes('/tiles/') && entry.startTime < picture);
    return {
      tilesBefore: tiles.length,
      root: tiles[0].responseEnd,
      script: Math.max(...scripts.map(({ responseEnd }) => responseEnd)),
      picture,
      now: performance.now(),
    };
  }, FIRST_PICTURE);
}

async function check(browser, report, { name, origin, pictures }) {
  const { page, tiles, bytes } = await openSlowly(browser, `${origin}/index.html?model=models/${name}.hier`);
  await page.waitForFunction((mark) => performance.getEntriesByName(mark).length > 0, FIRST_PICTURE, { timeout: PATIENCE, polling: 20 });
  const first = { asked: [...tiles], bytes: bytes() };
  await page.screenshot({ path: path.join(pictures, `${name}-first.png`) });
  await page.waitForFunction(() => window.meshhier.settled(), null, { timeout: PATIENCE });
  const { tilesBefore, root, script, picture, now } = await times(page);
  const stats = await page.evaluate(() => window.meshhier.stats());
  await page.screenshot({ path: path.join(pictures, `${name}-settled.png`) });
  const rootFirst = first.asked[0].endsWith('/tiles/00/000000.glb');
  report.line(`${name} first picture`, rootFirst && tilesBefore === 1 && stats.worstError <= 1.3,
    `${(picture - script).toFixed(0)} ms after the script (which took ${script.toFixed(0)}), ${tilesBefore} request of the mesh, ${first.bytes} bytes with the page; the root's file was whole ${Math.abs(root - picture).toFixed(0)} ms ${root > picture ? 'later' : 'before'}; ` +
      `within the error after ${((now - script) / 1000).toFixed(1)} s: ${stats.fetchedFiles} tiles, ${stats.fetchedBytes} bytes, ${stats.triangles} triangles, ` +
      `error ${stats.worstError.toFixed(2)} pixels`);
  await page.close();
}

async function checkAll(browser, report, [pictures, directory, ...others]) {
  const hierarchies = others.map(readHierarchy);
  const below = Object.fromEntries(hierarchies.map(({ name, directory: at }) => [`/models/${name}.hier`, at]));
  const server = await serve({ ...below, '': directory });
  for (const { name } of hierarchies) await check(browser, report, { name, origin: server.origin, pictures });
  server.close();
}

const [pictures, ...others] = process.argv.slice(2);
if (others.length < 2) {
  console.log('usage: node first_picture.mjs PICTURES PAGE HIERARCHY...');
  process.exit(2);
}
process.exit(await inChromium(pictures, (browser, report) => checkAll(browser, report, [pictures, ...others])));
