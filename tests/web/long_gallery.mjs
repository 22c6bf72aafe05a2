// The gallery of a folder with very many models: what is read before the first cells show, scrolling to the end, searching, tags, the map, and keys.
//
//   node long_gallery.mjs MESHHIER PICTURES HIERARCHY [COUNT]
//
// HIERARCHY: a small one, of which COUNT copies are listed (2000 if none is said). Times are told and decide nothing; bytes, counts and what is shown do.
// Exit code 2: wrong use; else see browser.mjs.
import { cpSync, linkSync, mkdirSync, mkdtempSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { collectComplaints, inChromium, until } from './browser.mjs';
import { startServer } from './meshhier_server.mjs';

const WIDE = { viewport: { width: 1100, height: 800 }, reducedMotion: 'reduce' };
const NARROW = { viewport: { width: 360, height: 640 }, reducedMotion: 'reduce', hasTouch: true };
const NAMES = ['amphora', 'basin', 'dragon', 'façade', 'lion', 'mask', 'owl', 'relief', 'urn', 'vase'];
const TAGS = ['marble', 'bronze', 'clay'];
const PART = 120; // models of one answer
const MOST_FIRST_BYTES = 100_000; // of the listing, before the first cells show

/// Copies of a hierarchy in 100 folders, which share its files but for their manifests; what is said of every second one tells a place.
function makeFolder(hierarchy, count) {
  const folder = mkdtempSync(path.join(tmpdir(), 'meshhier-long-'));
  const entries = readdirSync(hierarchy, { recursive: true, withFileTypes: true }).map((entry) => ({ name: path.relative(hierarchy, path.join(entry.parentPath ?? entry.path, entry.name)), isFolder: entry.isDirectory() }));
  const models = {};
  for (let i = 0; i < count; ++i) {
    const name = `site ${i % 100}/${NAMES[i % NAMES.length]} ${i}.hier`;
    mkdirSync(path.join(folder, name), { recursive: true });
    for (const { name: file } of entries.filter(({ isFolder }) => isFolder)) mkdirSync(path.join(folder, name, file), { recursive: true });
    for (const { name: file } of entries.filter(({ isFolder }) => !isFolder)) (file === 'hierarchy.json' ? cpSync : linkSync)(path.join(hierarchy, file), path.join(folder, name, file));
    const place = [((i * 7919) % 4000) / 100 - 10, ((i * 104729) % 3000) / 100 + 35];
    if (i % 2 === 0) models[name] = { title: `The ${NAMES[i % NAMES.length]} no. ${i}`, tags: [TAGS[i % 3]], place };
  }
  writeFileSync(path.join(folder, 'gallery.json'), JSON.stringify({ models }));
  return folder;
}

async function open(browser, url, size, complaints) {
  const page = await browser.newPage(size);
  collectComplaints(page, complaints, ['error', 'warning']);
  await page.goto(url);
  await page.locator('a.cell').first().waitFor();
  return page;
}

/// Bytes of the listing that were asked for, and when the page's first cell was there.
function account(page) {
  return page.evaluate(() => {
    const listings = performance.getEntriesByType('resource').filter(({ name }) => name.includes('models.json'));
    return { bytes: listings.reduce((sum, { decodedBodySize }) => sum + decodedBodySize, 0), count: listings.length, now: performance.now(), took: listings.at(0)?.duration ?? 0 };
  });
}

function note(page) {
  return page.locator('.gallery-note').innerText();
}

/// Milliseconds until the note says what fits.
async function searched(page, text, fits) {
  const began = Date.now();
  await page.getByRole('searchbox').fill(text);
  if (!(await until(page, async () => fits.test(await note(page))))) throw new Error(`${text}: ${await note(page)}`);
  return Date.now() - began;
}

/// What the server answers to a search, and milliseconds that it takes, at best of five.
async function askServer(url) {
  const { state } = await (await fetch(new URL('models.json?count=1', url))).json();
  const times = [];
  let answer;
  for (let i = 0; i < 5; ++i) {
    const began = performance.now();
    answer = await (await fetch(new URL(`models.json?count=${PART}&search=vase+9&state=${state}`, url))).json();
    times.push(performance.now() - began);
  }
  return { found: answer.models.length, took: Math.min(...times) };
}

async function checkWide(browser, report, { url, pictures, total, complaints }) {
  const page = await open(browser, url, WIDE, complaints);
  const first = await account(page);
  report.line('first cells', first.bytes < MOST_FIRST_BYTES && first.count === 1, `${first.bytes} bytes of the listing in ${first.took.toFixed(0)} ms; cells after ${first.now.toFixed(0)} ms`);
  report.line('all are counted', (await note(page)).startsWith(total.toLocaleString('en')), await note(page));
  const cells = () => page.locator('.cells > li').count();
  await page.screenshot({ path: path.join(pictures, 'long-gallery.png') });
  await page.evaluate(() => { window.scrollTo(0, document.body.scrollHeight); });
  const last = page.locator('a.cell').last();
  report.line('end', await until(page, async () => (await page.locator('.cell-slot').count()) === 0 && (await page.locator('a.cell').count()) > 0), `${(await last.innerText()).split('\n')[0]}, ${await cells()} cells of ${total}`);
  const atEnd = await account(page);
  report.line('scrolling reads parts', atEnd.bytes < 4 * MOST_FIRST_BYTES && (await cells()) < 200, `${atEnd.bytes} bytes in ${atEnd.count} requests`);
  await page.screenshot({ path: path.join(pictures, 'long-gallery-end.png') });
  await page.getByLabel('Order').selectOption('newest');
  await page.evaluate(() => { window.scrollTo(0, 0); });
  const took = await searched(page, 'vase 19', /^\d+ of/);
  const server = await askServer(url);
  report.line('search', server.found > 0 && server.found <= PART, `${await note(page)}, ${took} ms with the typing pause; the server finds ${server.found} in ${server.took.toFixed(0)}`);
  await searched(page, 'nothing has that', /No model/);
  await searched(page, '', /models$/);
  await page.getByLabel('Tag').selectOption('marble');
  report.line('tag', await until(page, async () => /^[\d,]+ of/.test(await note(page))), await note(page));
  await checkKeys(page, report);
  await checkMap(page, report, pictures);
  await page.close();
}

async function checkKeys(page, report) {
  await page.evaluate(() => document.activeElement?.blur());
  await page.keyboard.press('/');
  report.line('slash', (await page.getByRole('searchbox').inputValue()) === '', 'it is no text of the search');
  const focus = () => page.evaluate(() => document.activeElement?.className + document.activeElement?.textContent);
  const isSearch = (await focus()).includes('search');
  await page.keyboard.press('ArrowDown');
  const first = await focus();
  await page.keyboard.press('Shift+ArrowRight');
  const second = await focus();
  await page.keyboard.press('Shift+ArrowDown');
  const below = await focus();
  await page.keyboard.press('Home');
  const home = await focus();
  report.line('keys', isSearch && first.startsWith('cell') && new Set([first, second, below]).size === 3 && home === first, [first, second, below, home].join(' | '));
}

async function checkMap(page, report, pictures) {
  await page.getByRole('button', { name: 'Map', exact: true }).click();
  await page.locator('.map-mark').first().waitFor();
  const counted = async () => (await page.locator('.map-mark').allInnerTexts()).reduce((sum, text) => sum + Number(text.replaceAll(',', '') || 1), 0);
  const before = await counted();
  report.line('map', before > 0, `${before} models in ${await page.locator('.map-mark').count()} marks`);
  await page.screenshot({ path: path.join(pictures, 'long-gallery-map.png') });
  const most = await page.locator('.map-mark').evaluateAll((marks) => marks.map(({ textContent }) => Number(textContent.replaceAll(',', ''))).reduce((best, count, i, all) => (count > all[best] ? i : best), 0));
  await page.locator('.map-mark').nth(most).focus();
  await page.keyboard.press('Enter');
  const isNearer = async () => (await counted()) < before || (await page.locator('.map-list a').count()) > 1;
  report.line('map nearer', await until(page, isNearer), `${await counted()} models, ${await page.locator('.map-list a').count()} listed`);
  await page.screenshot({ path: path.join(pictures, 'long-gallery-map-near.png') });
  await page.locator('.map-sheet').focus();
  for (let i = 0; i < 12; ++i) await page.keyboard.press('+');
  await page.keyboard.press('0');
  report.line('map by keys', await until(page, async () => (await counted()) === before), 'all again');
  await page.getByRole('button', { name: 'Map', exact: true }).click();
  report.line('map closed', await page.locator('a.cell').first().isVisible(), 'the cells again');
}

async function checkNarrow(browser, report, { url, pictures, complaints }) {
  const page = await open(browser, url, NARROW, complaints);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  report.line('narrow', wide <= NARROW.viewport.width, `${wide} pixels wide`);
  await page.screenshot({ path: path.join(pictures, 'long-gallery-narrow.png') });
  await page.getByRole('button', { name: 'Map', exact: true }).tap();
  await page.locator('.map-mark').first().waitFor();
  await page.screenshot({ path: path.join(pictures, 'long-gallery-narrow-map.png') });
  const small = await page.locator('.map-mark, .map-buttons button, .toolbar > :not([hidden])').evaluateAll((all) => all.filter((one) => one.checkVisibility() && one.getBoundingClientRect().height < 40).length);
  report.line('by touch', small === 0, `${small} targets below 40 pixels`);
  await page.close();
}

async function check(browser, report, [meshhier, pictures, hierarchy, count = '2000']) {
  const folder = makeFolder(hierarchy, Number(count));
  const server = startServer(meshhier, folder);
  try {
    const url = await server.url;
    const { models } = await (await fetch(new URL('models.json', url))).json();
    const complaints = [];
    const given = { url, pictures, total: models.length, complaints };
    await checkWide(browser, report, given);
    await checkNarrow(browser, report, given);
    report.line('console', complaints.length === 0, complaints.join('; ') || 'no complaints');
  } finally {
    await server.stop();
    rmSync(folder, { recursive: true });
  }
}

const parameters = process.argv.slice(2);
if (parameters.length < 3 || parameters.length > 4) {
  console.log('usage: node long_gallery.mjs MESHHIER PICTURES HIERARCHY [COUNT]');
  process.exit(2);
}
process.exit(await inChromium(parameters[1], (browser, report) => check(browser, report, parameters)));
