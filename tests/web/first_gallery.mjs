// The gallery on a slow device behind a slow line: when the pictures of its models are there, and what they take.
//
//   node first_gallery.mjs MESHHIER PICTURES FOLDER
//
// FOLDER: of hierarchies with previews, as many as a window shows. Times are told and decide nothing; requests do. Exit code 2:
// wrong use; else see browser.mjs.
import path from 'node:path';
import { inChromium, PATIENCE, SLOW_LINE } from './browser.mjs';
import { startServer } from './meshhier_server.mjs';

const SLOWDOWN = 4;
const WINDOW = { viewport: { width: 1280, height: 900 }, reducedMotion: 'reduce' };

async function openSlowly(browser, url) {
  const page = await browser.newPage(WINDOW);
  page.setDefaultTimeout(SLOWDOWN * PATIENCE);
  const session = await page.context().newCDPSession(page);
  await session.send('Network.enable');
  await session.send('Network.emulateNetworkConditions', SLOW_LINE);
  await session.send('Emulation.setCPUThrottlingRate', { rate: SLOWDOWN });
  await page.goto(url);
  return page;
}

/// Milliseconds of the page's own clock, and what was asked for of the models.
function account(page) {
  return page.evaluate(() => {
    const entries = performance.getEntriesByType('resource');
    const script = Math.max(...entries.filter(({ name }) => /assets\/index[^/]*\.js$/.test(name)).map(({ responseEnd }) => responseEnd));
    const pictures = entries.filter(({ name }) => name.endsWith('/preview.webp'));
    const ends = pictures.map(({ responseEnd }) => responseEnd - script);
    return {
      script,
      first: Math.min(...ends),
      last: Math.max(...ends),
      count: pictures.length,
      bytes: pictures.reduce((sum, { encodedBodySize }) => sum + encodedBodySize, 0),
      others: entries.map(({ name }) => name).filter((name) => /\.hier\/|\.3tz\//.test(name) && !name.endsWith('/preview.webp')),
    };
  });
}

/// All cells whose picture can be seen show it.
function allShown(count) {
  const pictures = [...document.querySelectorAll('img.cell-picture')];
  return pictures.length >= count && pictures.every((picture) => picture.complete && picture.naturalWidth > 0);
}

async function check(browser, report, [meshhier, pictures, folder]) {
  const server = startServer(meshhier, folder);
  try {
    const url = await server.url;
    const { models } = await (await fetch(new URL('models.json', url))).json();
    const page = await openSlowly(browser, url);
    await page.waitForFunction(allShown, models.length, { polling: 50 });
    const { script, first, last, count, bytes, others } = await account(page);
    await page.screenshot({ path: path.join(pictures, 'first-gallery.png') });
    report.line('first gallery', count === models.length && others.length === 0,
      `pictures of ${count} of ${models.length} models, ${bytes} bytes: the first ${first.toFixed(0)} ms after the script (which took ` +
        `${script.toFixed(0)}), the last after ${last.toFixed(0)}; ${others.length} other requests of models${others.slice(0, 3).map((name) => ` ${name}`)}`);
    await page.close();
  } finally {
    await server.stop();
  }
}

const parameters = process.argv.slice(2);
if (parameters.length !== 3) {
  console.log('usage: node first_gallery.mjs MESHHIER PICTURES FOLDER');
  process.exit(2);
}
process.exit(await inChromium(parameters[1], (browser, report) => check(browser, report, parameters)));
