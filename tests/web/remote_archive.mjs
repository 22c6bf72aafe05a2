// The page of viewer/ and its element over an archive on a plain static host of another origin, which knows ranges: what is asked for, when
// the first picture is there behind a slow line, and that all is as in the directory. Then on a host that knows no ranges.
//
//   node remote_archive.mjs MESHHIER PICTURES PAGE HIERARCHY.hier HIERARCHY.3tz
//
// Both of the same mesh. Times are told and decide nothing; requests and bytes do. Exit code 2: wrong use; else see browser.mjs.
import path from 'node:path';
import { collectComplaints, inChromium, SLOW_LINE, until, withoutRestDetail } from './browser.mjs';
import { startServer } from './meshhier_server.mjs';
import { serve } from './server.mjs';

const FIRST_PICTURE = 'meshhier: first picture';

/// The page over a model, behind a line; what it asks of the model's host.
async function open(browser, url, model, line = SLOW_LINE) {
  const page = await browser.newPage({ viewport: { width: 800, height: 600 }, reducedMotion: 'reduce' });
  await page.addInitScript(withoutRestDetail);
  const session = await page.context().newCDPSession(page);
  await session.send('Network.enable');
  if (line !== null) await session.send('Network.emulateNetworkConditions', line);
  const asked = [];
  let bytes = 0;
  const ours = new Set();
  const complaints = [];
  collectComplaints(page, complaints);
  session.on('Network.requestWillBeSent', ({ requestId, request }) => {
    if (!request.url.startsWith(model)) return;
    ours.add(requestId);
    asked.push(`${request.method} ${request.headers.Range ?? request.url.slice(model.length)}`);
  });
  session.on('Network.dataReceived', ({ requestId, dataLength }) => { if (ours.has(requestId)) bytes += dataLength; });
  await page.goto(`${url}?model=${encodeURIComponent(model)}`);
  await page.waitForFunction((mark) => performance.getEntriesByName(mark).length > 0, FIRST_PICTURE, { polling: 20 });
  const first = { asked: asked.length, picture: await page.evaluate((mark) => performance.getEntriesByName(mark)[0].startTime, FIRST_PICTURE) };
  await page.waitForFunction(() => window.meshhier.settled());
  const stats = await page.evaluate(() => window.meshhier.stats());
  return { page, asked, bytes: () => bytes, first, stats, complaints };
}

/// Alternating, as this machine's speed changes.
async function firstPictures(browser, one, other, rounds) {
  const times = [[], []];
  for (let round = 0; round < rounds; ++round)
    for (const [i, [url, model]] of [one, other].entries()) {
      const { page, first } = await open(browser, url, model);
      times[i].push(first.picture);
      await page.close();
    }
  return times.map((each) => each.sort((a, b) => a - b)[Math.floor(rounds / 2)]);
}

async function checkShown(browser, report, [page, directory, archive, pictures]) {
  const [there, here] = await Promise.all([open(browser, page, archive), open(browser, page, directory)]);
  await there.page.screenshot({ path: path.join(pictures, 'remote-archive.png') });
  const same = ['tiles', 'triangles', 'vertices', 'worstError'].every((key) => there.stats[key] === here.stats[key]);
  report.line('an archive elsewhere', same && there.complaints.length === 0,
    `${there.stats.tiles} tiles, ${there.stats.triangles} triangles, error ${there.stats.worstError.toFixed(2)} pixels as of the directory; ${there.complaints.join('; ') || 'no errors'}`);
  report.line('requests of an archive', there.first.asked <= 5 && there.asked.every((each) => each.startsWith('GET bytes=')),
    `${there.first.asked} before the first picture, ${here.first.asked} of the directory; all: ${there.asked.length} and ${here.asked.length}, no preflight`);
  report.line('bytes of an archive', there.bytes() <= 1.02 * here.bytes() + 2 ** 14, `${there.bytes()}, of the directory ${here.bytes()}`);
  await there.page.close();
  await here.page.close();
}

async function checkRefused(browser, report, page, model) {
  const shown = await browser.newPage();
  await shown.goto(`${page}?model=${encodeURIComponent(model)}`);
  const tells = await until(shown, () => shown.evaluate(() => document.body.textContent.includes('could not be fetched') || document.body.textContent.includes('HTTP ranges')));
  report.line('a host without CORS', tells, 'is told');
  await shown.close();
}

async function checkWhole(browser, report, page, model) {
  const { page: shown, stats, asked } = await open(browser, page, model, null);
  report.line('a host without ranges', stats.tiles > 0 && asked.length === 1, `sends a small archive whole: ${stats.tiles} tiles after ${asked.length} request`);
  await shown.close();
}

async function checkAll(browser, report, [meshhier, pictures, pageDirectory, directory, archive]) {
  const site = await serve({ '': pageDirectory });
  const host = await serve({ '/models': path.dirname(archive) }, { ranges: true });
  const plain = await serve({ '/models': path.dirname(archive), '': pageDirectory });
  const server = startServer(meshhier, path.dirname(directory), '--viewer', pageDirectory);
  const [name, packed] = [path.basename(directory), path.basename(archive)];
  const page = `${site.origin}/index.html`;
  const served = await server.url;
  await checkShown(browser, report, [`${served}`, `${served}models/${name}`, `${host.origin}/models/${packed}`, pictures]);
  await checkWhole(browser, report, `${plain.origin}/index.html`, `${plain.origin}/models/${packed}`);
  await checkRefused(browser, report, page, `${plain.origin}/models/${packed}`);
  const [far, near] = await firstPictures(browser, [page, `${host.origin}/models/${packed}`], [served, `${served}models/${name}`], 3);
  report.line('first picture of an archive', true, `${far.toFixed(0)} ms behind a slow line, ${near.toFixed(0)} of the directory that meshhier serves: ${(far / near).toFixed(2)} times`);
  for (const each of [site, host, plain]) each.close();
  await server.stop();
}

const [meshhier, pictures, ...others] = process.argv.slice(2);
if (others.length !== 3) {
  console.log('usage: node remote_archive.mjs MESHHIER PICTURES PAGE HIERARCHY.hier HIERARCHY.3tz');
  process.exit(2);
}
process.exit(await inChromium(pictures, (browser, report) => checkAll(browser, report, [meshhier, pictures, ...others])));
