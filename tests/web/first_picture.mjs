// The page of viewer/ on a slow device behind a slow line: when the hierarchy's own picture is there, when the model can be turned, and what
// both and the finished view take.
//
//   node first_picture.mjs PICTURES PAGE HIERARCHY...
//
// PAGE: the directory that `npm run build` of viewer/ makes. Times are told and decide nothing; requests, bytes and programs do. Exit code 2:
// wrong use; else see browser.mjs.
import path from 'node:path';
import { inChromium, PATIENCE, readHierarchy, SLOW_LINE } from './browser.mjs';
import { serve } from './server.mjs';

const SLOWDOWN = 4;
const PHONE = { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true };
const PREVIEW = 'meshhier: preview';
const FIRST_PICTURE = 'meshhier: first picture';
/// Of scripts and styles before the model can be turned, as they come. Whoever adds to what must be there first reads this first.
const MOST_CODE = 215_000; // bytes
const MOST_FILES = 8;
/// A mesh is drawn by one program; those of tiles with other parts come after the first picture.
const MOST_PROGRAMS = 1;

/// The page on a slow device, and each tile that it asks for with the time it took.
async function openSlowly(browser, url) {
  const page = await browser.newPage({ reducedMotion: 'reduce', ...PHONE });
  page.setDefaultTimeout(SLOWDOWN * PATIENCE);
  const session = await page.context().newCDPSession(page);
  await session.send('Network.enable');
  await session.send('Network.emulateNetworkConditions', SLOW_LINE);
  await session.send('Emulation.setCPUThrottlingRate', { rate: SLOWDOWN });
  await page.addInitScript(countPrograms);
  const tiles = [];
  let bytes = 0;
  page.on('request', (request) => request.url().includes('/tiles/') && tiles.push(request.url()));
  session.on('Network.dataReceived', ({ encodedDataLength }) => (bytes += encodedDataLength)); // of files that are still coming, too
  await page.goto(url);
  return { page, tiles, bytes: () => bytes };
}

/// To run in the page: marks each program that is made.
function countPrograms() {
  const { prototype } = WebGL2RenderingContext;
  const { linkProgram } = prototype;
  prototype.linkProgram = function link(...given) {
    performance.mark('program');
    return linkProgram.apply(this, given);
  };
}

/// Milliseconds of the page's own clock; what was asked for before the first picture, and the programs that were made by then.
function times(page) {
  return page.evaluate(([preview, first]) => {
    const picture = performance.getEntriesByName(first)[0].startTime;
    const before = performance.getEntriesByType('resource').filter((entry) => entry.startTime < picture);
    const tiles = before.filter(({ name }) => name.includes('/tiles/'));
    const code = [...new Map(before.filter(({ name }) => /\.(js|css)$/.test(name)).map((entry) => [entry.name, entry])).values()];
    return {
      tilesBefore: tiles.length,
      codeFiles: code.length,
      codeBytes: code.reduce((sum, { encodedBodySize }) => sum + encodedBodySize, 0),
      programs: performance.getEntriesByName('program').filter(({ startTime }) => startTime <= picture).length,
      root: tiles[0].responseEnd,
      script: Math.max(...code.filter(({ responseEnd }) => responseEnd < picture).map(({ responseEnd }) => responseEnd)),
      preview: performance.getEntriesByName(preview)[0]?.startTime ?? Infinity,
      picture,
      now: performance.now(),
    };
  }, [PREVIEW, FIRST_PICTURE]);
}

async function check(browser, report, { name, origin, pictures }) {
  const { page, tiles, bytes } = await openSlowly(browser, `${origin}/index.html?model=models/${name}.hier`);
  const marked = (name) => page.waitForFunction((mark) => performance.getEntriesByName(mark).length > 0, name, { polling: 20 });
  await marked(PREVIEW);
  await marked(FIRST_PICTURE);
  const first = { asked: [...tiles], bytes: bytes() };
  await page.screenshot({ path: path.join(pictures, `${name}-first.png`) });
  await page.waitForFunction(() => window.meshhier.settled());
  const { tilesBefore, codeFiles, codeBytes, programs, root, script, preview, picture, now } = await times(page);
  const stats = await page.evaluate(() => window.meshhier.stats());
  await page.screenshot({ path: path.join(pictures, `${name}-settled.png`) });
  const rootFirst = first.asked[0].endsWith('/tiles/00/000000.glb');
  report.line(`${name} first picture`, rootFirst && tilesBefore === 1 && stats.worstError <= 1.3,
    `${(picture - script).toFixed(0)} ms after the script (which took ${script.toFixed(0)}), ${tilesBefore} request of the mesh, ${first.bytes} bytes with the page; the root's file was whole ${Math.abs(root - picture).toFixed(0)} ms ${root > picture ? 'later' : 'before'}; ` +
      `within the error after ${((now - script) / 1000).toFixed(1)} s: ${stats.fetchedFiles} tiles, ${stats.fetchedBytes} bytes, ${stats.triangles} triangles, ` +
      `error ${stats.worstError.toFixed(2)} pixels`);
  report.line(`${name} before it can be turned`, codeBytes <= MOST_CODE && codeFiles <= MOST_FILES && programs <= MOST_PROGRAMS,
    `its own picture after ${preview.toFixed(0)} ms, the model after ${picture.toFixed(0)}; ${codeFiles} files of code with ${codeBytes} bytes (${MOST_CODE} at the most), ${programs} program`);
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
