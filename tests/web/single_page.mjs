// `meshhier page`: one HTML file that opens from the disk without a network, goes on from a link when there is one, and a site on a
// plain host.
//
//   node single_page.mjs MESHHIER PICTURES PAGE HIERARCHY.hier HIERARCHY.3tz
//
// Both of the same mesh. Exit code 2: wrong use; else see browser.mjs.
import { execFileSync } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, rmSync, statSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { collectComplaints, comparePictures, frames, inChromium, until, withoutRestDetail } from './browser.mjs';
import { serve } from './server.mjs';

/// The part of a page with all tiles whose coarsest tile is off by more than a rounding to 16 bits.
const ROUNDED_SHARE = 0.3;
const PHONE = { viewport: { width: 390, height: 700 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true };

/// A page at rest: what it shows, asked for and complained about.
async function open(browser, url, { offline = false, phone = false } = {}) {
  const context = await browser.newContext(phone ? PHONE : { viewport: { width: 1000, height: 800 } });
  await context.setOffline(offline);
  const page = await context.newPage();
  await page.addInitScript(withoutRestDetail);
  const complaints = [];
  collectComplaints(page, complaints);
  const asked = [];
  page.on('request', (request) => /^https?:/.test(request.url()) && asked.push(request.url()));
  await page.goto(url);
  await page.waitForFunction(() => window.meshhier?.settled());
  return { page, context, asked, complaints, stats: await page.evaluate(() => window.meshhier.stats()) };
}

/// Nearer, so that finer tiles are wanted.
async function closeIn(page) {
  for (let i = 0; i < 12; ++i) {
    await page.mouse.move(500, 400);
    await page.mouse.wheel(0, -400);
    await frames(page);
  }
  await page.waitForFunction(() => window.meshhier.settled());
  return page.evaluate(() => window.meshhier.stats());
}

async function checkAlone(browser, report, file, pictures) {
  for (const phone of [false, true]) {
    const { page, context, asked, complaints, stats } = await open(browser, pathToFileURL(file).href, { offline: true, phone });
    const near = phone ? stats : await closeIn(page);
    await page.screenshot({ path: path.join(pictures, `single-page${phone ? '-phone' : ''}.png`) });
    report.line(`a page from the disk${phone ? ', on a phone' : ''}`, stats.triangles > 1000 && near.finestLevel > 0 && near.failed === 0 && asked.length === 0 && complaints.length === 0,
      `${statSync(file).size} bytes, offline: ${stats.tiles} tiles, ${stats.triangles} triangles, nearer to level ${near.finestLevel}; ${complaints.join('; ') || 'no errors'}`);
    await context.close();
  }
}

async function checkLinked(browser, report, file, alone) {
  const online = await open(browser, pathToFileURL(file).href);
  const near = await closeIn(online.page);
  report.line('a page with a link, online', near.finestLevel > alone && online.complaints.length === 0 && online.asked.length > 0,
    `to level ${near.finestLevel}, without it ${alone}; ${online.asked.length} requests; ${online.complaints.join('; ') || 'no errors'}`);
  await online.context.close();
  const offline = await open(browser, pathToFileURL(file).href, { offline: true });
  const rested = await closeIn(offline.page);
  report.line('a page with a link, offline', rested.triangles > 1000, `shows what it has: ${rested.tiles} tiles to level ${rested.finestLevel}`);
  await offline.context.close();
}

/// Where positions are rounded, the picture is that of the exact ones.
async function checkRounded(browser, report, make, directory, [exact, rounded]) {
  make(directory, '-o', exact, '--size', '500MB');
  const told = make(directory, '-o', rounded, '--size', String(Math.round(statSync(exact).size * ROUNDED_SHARE)));
  const pictures = [];
  for (const file of [exact, rounded]) {
    const { page, context } = await open(browser, pathToFileURL(file).href, { offline: true });
    pictures.push(await page.screenshot());
    await context.close();
  }
  const page = await browser.newPage();
  const { most, mean, covered } = await comparePictures(page, ...pictures);
  await page.close();
  report.line('a page with rounded positions', /rounded to 16 bits/.test(told) && covered > 0.05 && mean < 0.5,
    `${statSync(rounded).size} bytes of ${statSync(exact).size}: ${mean.toFixed(3)} of 255 apart on average, ${most} at most; ${told.split('\n')[0]}`);
}

async function checkSite(browser, report, site, names) {
  const host = await serve({ '': site }, { ranges: true });
  const page = await browser.newPage();
  const complaints = [];
  collectComplaints(page, complaints);
  await page.goto(`${host.origin}/index.html`);
  const listed = await until(page, () => page.evaluate((count) => [...document.querySelectorAll('img')].filter((img) => img.naturalWidth > 0).length === count, names.length));
  report.line('a site', listed && complaints.length === 0, `lists ${names.length} models with their pictures; ${complaints.join('; ') || 'no errors'}`);
  for (const name of names) {
    await page.goto(`${host.origin}/index.html#models/${name}`);
    await page.waitForFunction(() => window.meshhier?.settled());
    const { triangles } = await page.evaluate(() => window.meshhier.stats());
    report.line(`a site's ${name}`, triangles > 1000 && complaints.length === 0, `${triangles} triangles; ${complaints.join('; ') || 'no errors'}`);
  }
  await page.close();
  host.close();
}

async function checkAll(browser, report, [meshhier, pictures, viewer, directory, archive]) {
  const work = mkdtempSync(path.join(tmpdir(), 'meshhier-page-'));
  const make = (...words) => execFileSync(meshhier, ['page', ...words, '--viewer', viewer], { encoding: 'utf8' });
  const [alone, linked, site] = ['alone.html', 'linked.html', 'site'].map((name) => path.join(work, name));
  const host = await serve({ '/models': path.dirname(archive) }, { ranges: true });
  make(directory, '-o', alone, '--size', '3MB');
  make(archive, '-o', linked, '--size', '3MB', '--link', `${host.origin}/models/${path.basename(archive)}`);
  await checkAlone(browser, report, alone, pictures);
  const { page, context } = await open(browser, pathToFileURL(alone).href);
  const { finestLevel } = await closeIn(page);
  await context.close();
  await checkLinked(browser, report, linked, finestLevel);
  await checkRounded(browser, report, make, directory, ['exact.html', 'rounded.html'].map((name) => path.join(work, name)));
  const models = path.join(work, 'models');
  mkdirSync(models);
  for (const each of [directory, archive]) cpSync(each, path.join(models, path.basename(each)), { recursive: true });
  make(models, '-o', site);
  await checkSite(browser, report, site, [directory, archive].map((each) => path.basename(each)));
  host.close();
  rmSync(work, { recursive: true });
}

const [meshhier, pictures, ...others] = process.argv.slice(2);
if (others.length !== 3) {
  console.log('usage: node single_page.mjs MESHHIER PICTURES PAGE HIERARCHY.hier HIERARCHY.3tz');
  process.exit(2);
}
process.exit(await inChromium(pictures, (browser, report) => checkAll(browser, report, [meshhier, pictures, ...others])));
