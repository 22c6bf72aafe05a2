// Checks the page of viewer/ in headless Chromium, from a plain static server: gallery, modes, links,
// keyboard, narrow screens, and what it says when something is missing.
//
//   node viewer_page.mjs PICTURES PAGE HIERARCHY...
//
// PAGE: the directory that `npm run build` of viewer/ makes, dist/page. The first hierarchy should have some
// partitions. Each share has an eighth of most checks (MESHHIER_TEST_SHARE). Pictures go to the directory PICTURES. Exit code 2: wrong use; else see browser.mjs.
import path from 'node:path';
import { comparePictures, inChromium, inTurn, loseDevice, readHierarchy, steady, until, withoutRestDetail } from './browser.mjs';
import { withSite } from './site.mjs';

const WIDE = { viewport: { width: 1280, height: 800 } };
const NARROW = { viewport: { width: 360, height: 640 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true };
const LEAST_TARGET = 40; // CSS pixels
const MANY = 3000; // models in a long listing
const MOST_CELLS = 60; // of them that are elements of the page
const JOBS = [
  { name: 'half.ply', state: 'building', stage: 'simplify', progress: 0.5, seconds_left: 90 },
  { name: '<b>bad</b>.ply', state: 'failed', message: '<b>bad</b>.ply: byte 7: <i>nothing</i>' },
];
const PICTURE = 'preview.webp';
const DOT = 'UklGRiIAAABXRUJQVlA4IBYAAAAwAQCdASoBAAEADsD+JaQAA3AAAAAA'; // a WebP of one pixel

/// The same path, written in another way for each number: letters are percent-encoded where it has ones.
function disguised(path, number) {
  let rest = number;
  return path.replace(/[a-z]/g, (letter) => {
    const isEncoded = rest % 2 === 1;
    rest = Math.floor(rest / 2);
    return isEncoded ? `%${letter.charCodeAt(0).toString(16)}` : letter;
  });
}

/// Listings beside the usual one: of one model, written by hand; of many and two jobs, where each third has a picture; in folders.
function moreListings(models) {
  const [{ path }] = models;
  const many = Array.from({ length: MANY }, (_, i) => ({ name: `model ${i}`, path: disguised(path, i), triangles: i, vertices: 1, ...(i % 3 === 0 && { preview: PICTURE }) }));
  const folders = ['b/../', 'a/../', ''].map((folder) => ({ path: `${folder}${path}` }));
  return { 'one.json': { models: [{ path }] }, 'many.json': { models: many, jobs: JOBS }, 'folders.json': { models: folders } };
}

class Visitor {
  constructor(browser, origin, report) {
    Object.assign(this, { browser, origin, report });
  }

  /// A page at `link`, with what it asked for and what its console complained of.
  async open(link, { prepare = null, routes = null, restDetail = false, ...options } = WIDE) {
    const page = await this.browser.newPage({ reducedMotion: 'reduce', ...options });
    if (!restDetail) await page.addInitScript(withoutRestDetail);
    if (prepare !== null) await page.addInitScript(prepare);
    await routes?.(page);
    page.asked = [];
    page.complaints = [];
    page.on('request', (request) => page.asked.push(request.url().replace(`${this.origin}/`, '')));
    page.on('console', (message) => {
      if (['error', 'warning'].includes(message.type())) page.complaints.push(message.text());
    });
    page.on('pageerror', (error) => page.complaints.push(String(error)));
    await page.goto(`${this.origin}/index.html${link}`);
    return page;
  }

  async close(page, what) {
    this.report.line(`${what} console`, page.complaints.length === 0, page.complaints.join('; ') || 'no complaints');
    await page.close();
  }

  check(what, good, text = '') {
    this.report.line(what, good, text);
  }
}

/// Whether the picture of a part of the page becomes another one.
function changes(part, before) {
  return until(part.page(), async () => !before.equals(await part.screenshot()));
}

/// The picture of a part of the page, once it stands still.
function still(part) {
  return steady(part.page(), () => part.screenshot());
}

function settle(page) {
  return page.waitForFunction(() => window.meshhier.settled());
}

/// Returns the view's mode, by Kim & Lee's names.
function mode(page) {
  return page.locator('.badge:visible').getAttribute('data-mode');
}

async function press(page, ...keys) {
  for (const key of keys) await page.keyboard.press(key);
  await settle(page);
}

/// Controls that can be seen.
function targets(page) {
  return page.evaluate(() =>
    [...document.querySelectorAll('button, a, input:not([type=radio]):not([type=checkbox]), label:has(input)')]
      .filter((one) => one.checkVisibility({ visibilityProperty: true }))
      .map((one) => {
        const { left, top, right, bottom } = one.getBoundingClientRect();
        const name = one.getAttribute('aria-label') ?? one.textContent;
        return { name, left, top, right, bottom, inSheet: one.closest('.sheet') !== null };
      }));
}

function overlap(a, b) {
  return Math.min(a.right, b.right) - Math.max(a.left, b.left) > 0.5 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 0.5;
}

// ---- the gallery

/// How many outlines were asked for.
function outlinesOf(page) {
  return page.asked.filter((file) => file.endsWith('/outline.glb')).length;
}

async function paintedCells(page, names) {
  await page.waitForFunction((count) => document.querySelectorAll('a.cell').length === count, names.length);
  await until(page, () => outlinesOf(page) >= names.length);
  await page.waitForFunction(() => document.querySelector('.cell-stage.waiting') === null);
  return page.locator('a.cell').evaluateAll((cells) => cells.map((cell) => cell.querySelector('.cell-name').textContent));
}

function hasSizes(text) {
  return /triangles.*B/s.test(text);
}

async function checkGallery(visitor, names, pictures) {
  const page = await visitor.open('');
  const shown = await paintedCells(page, names);
  visitor.check('gallery cells', shown.join() === [...names].sort().join(), shown.join(' '));
  const expected = ['models.json', ...names.map((name) => `models/${name}.hier/outline.glb`)];
  const asked = page.asked.filter((file) => file !== 'index.html' && !file.startsWith('assets/')).map((file) => file.replace(/\?.*/, ''));
  const sizes = await page.locator('.cell-size').allInnerTexts();
  visitor.check('gallery sizes', sizes.length === names.length && sizes.every(hasSizes), sizes.join(', '));
  visitor.check('gallery requests', asked.sort().join() === expected.sort().join(), asked.join(' '));
  await checkTurning(visitor, page);
  await page.screenshot({ path: path.join(pictures, 'page-gallery.png') });
  await visitor.close(page, 'gallery');
}

async function checkTurning(visitor, page) {
  const stage = page.locator('.cell-stage').first();
  const { x, y, width, height } = await stage.boundingBox();
  const [middleX, middleY] = [x + width / 2, y + height / 2];
  const calm = await still(stage);
  await page.mouse.move(middleX, middleY);
  visitor.check('gallery pointed at', await changes(stage, calm), 'has another colour');
  await page.locator('a.cell').first().locator('.solid > canvas.cell-solid').waitFor();
  const solid = await still(stage);
  await page.waitForTimeout(300);
  visitor.check('gallery reduced motion', solid.equals(await stage.screenshot()), 'outlines stand still');
  await page.mouse.down();
  await page.mouse.move(middleX + 60, middleY, { steps: 4 });
  await page.mouse.up();
  visitor.check('gallery drag', (await changes(stage, solid)) && !page.url().includes('#'), `turned, and ${page.url()} stays`);
  await page.locator('a.cell').first().focus();
  const dragged = await still(stage);
  await page.keyboard.press('ArrowRight');
  visitor.check('gallery arrow keys', await changes(stage, dragged), 'turned');
}

/// The cell that is pointed at turns, and no other.
async function checkMotion(visitor, names) {
  const page = await visitor.open('', { ...WIDE, reducedMotion: 'no-preference' });
  await paintedCells(page, names);
  const stage = page.locator('.cell-stage').first();
  const resting = await still(stage);
  await page.waitForTimeout(300);
  visitor.check('gallery rest', resting.equals(await stage.screenshot()), 'outlines stand still');
  await stage.hover();
  await changes(stage, resting);
  visitor.check('gallery motion', await changes(stage, await stage.screenshot()), 'the outline pointed at turns');
  await visitor.close(page, 'gallery motion');
}

/// A long listing on a narrow screen: only what is near the window is there and fetched; a finger scrolls, or turns.
async function checkLongGallery(visitor) {
  const page = await visitor.open('?models=many.json', { ...NARROW, routes: withPicture });
  await until(page, () => outlinesOf(page) > 0);
  await page.waitForFunction(() => document.querySelector('.cell-stage.waiting') === null);
  await page.waitForTimeout(300); // for those that should not be asked for
  const fetched = outlinesOf(page);
  const cells = await page.locator('a.cell').count();
  visitor.check('gallery fetches what is near', fetched > 0 && fetched < cells, `${fetched} outlines of ${MANY}`);
  visitor.check('gallery has what is near', cells > 4 && cells < MOST_CELLS, `${cells} cells of ${MANY}`);
  visitor.check('gallery progress', (await page.getByRole('progressbar', { name: 'half.ply: progress' }).getAttribute('value')) === '0.5', '0.5');
  const failed = await page.locator('.job-failed').innerText();
  visitor.check('gallery failure', failed.split('<b>bad</b>.ply').length === 2 && failed.includes('byte 7: <i>nothing</i>'), failed);
  const box = await page.locator('a.cell').first().boundingBox();
  const place = [box.x + box.width / 2, box.y + box.height / 2];
  await swipe(page, place, [60, 4]);
  visitor.check('gallery swipe across', (await page.evaluate(() => scrollY)) === 0 && !page.url().includes('#'), 'turns');
  await swipe(page, place, [0, -120]);
  const scrolls = await until(page, () => page.evaluate(() => scrollY > 50));
  visitor.check('gallery swipe up', scrolls && !page.url().includes('#'), 'scrolls');
  await checkFarCells(visitor, page);
  await checkSearch(visitor, page);
  await visitor.close(page, 'long gallery');
}

/// The end of a long listing; the picture of a model is shown until it is pointed at.
async function checkFarCells(visitor, page) {
  await page.evaluate(() => scrollTo(0, document.documentElement.scrollHeight));
  const last = page.locator('a.cell', { hasText: `model ${MANY - 1}` });
  await last.waitFor();
  const counts = await page.locator('li:has(a.cell)').last().evaluate((one) => [one.ariaPosInSet, one.ariaSetSize].join());
  visitor.check('gallery end', counts === `${MANY},${MANY}` && (await page.locator('a.cell').count()) < MOST_CELLS, counts);
  const pictured = page.locator('a.cell', { hasText: `model ${MANY - 3}` });
  await pictured.locator('.cell-picture:visible').waitFor();
  await pictured.focus();
  await pictured.locator('.cell-outline:visible').waitFor();
  visitor.check('gallery picture', !(await pictured.locator('.cell-picture').isVisible()), 'becomes an outline under the focus');
  await pictured.locator('.solid > canvas.cell-solid').waitFor();
  const tiles = await page.evaluate(() => performance.getEntriesByType('resource').filter(({ name }) => name.includes('/tiles/')).map(({ name }) => name));
  visitor.check('gallery root', tiles.length > 0 && tiles.every((name) => name.endsWith('/tiles/00/000000.glb')), `shaded where one stays: ${tiles.length} tiles, all of them roots`);
  await page.evaluate(() => scrollTo(0, 0));
  await page.locator('a.cell', { hasText: 'model 0' }).first().waitFor();
  visitor.check('gallery focus', await pictured.evaluate((one) => document.activeElement === one), 'stays where it was');
}

async function checkSearch(visitor, page) {
  const names = () => page.locator('.cell-name').allInnerTexts();
  await page.getByRole('searchbox', { name: 'Search' }).fill('1234');
  await page.locator('.gallery-note', { hasText: `1 of ${MANY.toLocaleString('en')} models` }).waitFor();
  visitor.check('gallery search', (await names()).join() === 'model 1234', await page.locator('.gallery-note').innerText());
  await page.getByRole('searchbox').fill('no such');
  await page.locator('.gallery-note', { hasText: 'no such' }).waitFor();
  visitor.check('gallery search in vain', (await names()).length === 0, await page.locator('.gallery-note').innerText());
  await page.getByRole('searchbox').fill('model');
  await page.getByRole('combobox', { name: 'Order' }).selectOption('triangles');
  await page.locator('a.cell').first().filter({ hasText: `model ${MANY - 1}` }).waitFor();
  visitor.check('gallery order', true, 'most triangles first');
}

async function checkFolders(visitor, [name]) {
  const page = await visitor.open('?models=folders.json');
  await page.locator('.group-name').first().waitFor();
  const groups = await page.locator('.group').evaluateAll((all) => all.map((one) => `${one.querySelector('h2')?.textContent ?? ''}: ${[...one.querySelectorAll('.cell-name')].map((cell) => cell.textContent)}`));
  visitor.check('gallery folders', groups.join('; ') === `a/../models: ${name}; b/../models: ${name}; models: ${name}`, groups.join('; '));
  await visitor.close(page, 'gallery folders');
}

/// The picture that some models of the long listing have.
function withPicture(page) {
  return page.route(`**/${PICTURE}`, (route) => route.fulfill({ contentType: 'image/webp', body: Buffer.from(DOT, 'base64') }));
}

/// One finger from a place by a way.
async function swipe(page, [x, y], [right, down]) {
  const client = await page.context().newCDPSession(page);
  const touch = (type, touchPoints) => client.send('Input.dispatchTouchEvent', { type, touchPoints });
  await touch('touchStart', [{ x, y }]);
  for (let step = 1; step <= 8; ++step) {
    await touch('touchMove', [{ x: x + (right * step) / 8, y: y + (down * step) / 8 }]);
    await page.waitForTimeout(30);
  }
  await touch('touchEnd', []);
  await page.waitForTimeout(500);
}

/// A listing that cannot be had at first, and whose only job ends and leaves nothing.
async function checkChangingListing(visitor) {
  const answers = [{ status: 503 }, { json: { models: [], jobs: [JOBS[0]] } }, { json: { models: [], jobs: [] } }];
  let looks = 0;
  const routes = (page) => page.route('**/changing.json*', (route) => route.fulfill(answers[Math.min(looks++, answers.length - 1)]));
  const page = await visitor.open('?models=changing.json', { ...WIDE, routes });
  const note = page.locator('.gallery-note');
  await note.filter({ hasText: '503' }).waitFor();
  await page.locator('.job').waitFor();
  visitor.check('listing asked for again', looks >= 2, 'after 503');
  await note.filter({ hasText: 'is empty' }).waitFor();
  visitor.check('listing without entries', (await page.locator('.cell').count()) === 0, 'leaves no cells');
  await page.close();
}

/// An outline that fails is asked for once more when its cell is seen again.
async function checkOutlineAgain(visitor, [name]) {
  let refused = 0;
  const prepare = async (page) => {
    await page.route('**/preview.webp', (route) => route.fulfill({ status: 404 })); // where there is a picture, no outline is asked for
    await page.route('**/outline.glb', (route) => (++refused === 1 ? route.fulfill({ status: 503 }) : route.continue()));
  };
  const page = await visitor.open('?models=one.json', { ...WIDE, routes: prepare });
  await page.locator('.cell-problem').waitFor();
  visitor.check('outline failed', (await page.locator('.cell-problem').innerText()).includes('503'), await page.locator('.cell-problem').innerText());
  await page.evaluate((one) => window.meshhier.open(one), name);
  await settle(page);
  await page.evaluate(() => window.meshhier.close());
  await page.locator('.cell-outline:visible').waitFor();
  visitor.check('outline again', refused === 2, `${refused} requests`);
  await page.locator('.cell-size', { hasText: 'triangles' }).waitFor();
  const text = await page.locator('.cell-size').innerText();
  visitor.check('sizes of a model without', hasSizes(text), text);
  await page.close();
}

// ---- a model

function anchor(name) {
  return `#models/${name}.hier`;
}

async function checkModes(visitor, name, pictures) {
  const page = await visitor.open('', { ...WIDE, restDetail: true });
  await page.locator('a.cell', { hasText: name }).first().click();
  await settle(page);
  const tiles = page.asked.filter((file) => file.includes('/tiles/'));
  visitor.check('view first tile', tiles[0]?.endsWith('tiles/00/000000.glb'), tiles[0]);
  visitor.check('view mode', (await mode(page)) === 'CWV', await page.locator('.badge').innerText());
  await page.screenshot({ path: path.join(pictures, 'page-whole.png') });
  await checkDepth(visitor, page, pictures);
  await checkWayBack(visitor, page);
  await visitor.close(page, 'view');
}

async function checkDepth(visitor, page, pictures) {
  await press(page, ...Array(8).fill('+'), 'ArrowLeft', 'Shift+ArrowUp');
  const zoomed = await mode(page);
  visitor.check('view zoomed', /^(ZSV|DZM)/.test(zoomed), zoomed);
  await page.waitForFunction(() => location.hash.includes('&'));
  await press(page, 'w', 'p', '3', 's');
  let figures = '';
  const isFilled = await until(page, async () => {
    figures = await page.getByRole('region', { name: 'Figures' }).innerText();
    return /Triangles\s+[1-9]/.test(figures);
  });
  visitor.check('view figures', isFilled, figures.replace(/\s+/g, ' '));
  const look = await page.evaluate(() => window.meshhier.view.look);
  visitor.check('view look keys', look.wires && look.points && look.colours === 'partition', JSON.stringify(look));
  await page.screenshot({ path: path.join(pictures, 'page-zoomed.png') });
  await press(page, 'w', 'p', '2', 's');
}

async function checkWayBack(visitor, page) {
  await press(page, 'Escape');
  visitor.check('back to the whole', (await mode(page)) === 'CWV', await page.locator('.badge').innerText());
  await page.keyboard.press('Escape');
  await page.locator('.gallery-header').waitFor();
  visitor.check('back to the gallery', !page.url().includes('#'), page.url());
  await page.goForward();
  await settle(page);
  visitor.check('forward to the model', page.url().includes('#models/'), page.url());
  await page.getByRole('button', { name: 'Back' }).click();
  await page.locator('.gallery-header').waitFor();
  visitor.check('back button', !page.url().includes('#'), page.url());
}

/// Without the ring that keys make.
async function picture(page) {
  await page.evaluate(() => { document.documentElement.dataset.input = 'pointer'; });
  return page.locator('canvas:visible').screenshot();
}

/// To a part of the distance from the target, and back.
async function thereAndBack(page, part) {
  const { position, target } = await page.evaluate(() => window.meshhier.camera());
  const closer = target.map((from, axis) => from + part * (position[axis] - from));
  for (const each of [closer, position]) {
    await page.evaluate((pose) => {
      window.meshhier.setCamera(pose);
      return new Promise(requestAnimationFrame); // it was seen
    }, { position: each, target });
    await settle(page);
  }
}

async function checkLinks(visitor, [name]) {
  const page = await visitor.open(anchor(name));
  await settle(page);
  const root = page.asked.findIndex((file) => file.endsWith('tiles/00/000000.glb'));
  visitor.check('link root early', root >= 0 && !page.asked.slice(0, root).some((file) => file.includes('models.json')), page.asked.slice(0, root + 1).join(' '));
  await press(page, '+', '+', '+', 'ArrowLeft', 'ArrowUp');
  await page.waitForFunction(() => {
    const { position, target } = window.meshhier.camera();
    return location.hash.endsWith(`&${[...position, ...target].join(',')}`);
  });
  await settle(page);
  const [link, before] = [new URL(page.url()).hash, await picture(page)];
  const again = await visitor.open(link);
  await settle(again);
  visitor.check('link restores the picture', before.equals(await picture(again)), link);
  visitor.check('link stays', new URL(again.url()).hash === link, new URL(again.url()).hash);
  await thereAndBack(again, 0.9);
  visitor.check('way back restores the picture', before.equals(await picture(again)), link);
  await visitor.close(again, 'link again');
  await visitor.close(page, 'link');
}

/// From where the camera looks at its target.
function seenFrom({ position, target }) {
  const away = position.map((value, axis) => value - target[axis]);
  const distance = Math.hypot(...away);
  return away.map((value) => value / distance);
}

async function checkFirstView(visitor, [name]) {
  const page = await visitor.open(anchor(name));
  await settle(page);
  const [camera, { first_view: { azimuth, elevation } }] = await page.evaluate(
    async (file) => [window.meshhier.camera(), await (await fetch(file)).json()], `models/${name}.hier/hierarchy.json`);
  const [around, above] = [azimuth, elevation].map((degrees) => (degrees * Math.PI) / 180);
  const told = [Math.sin(around) * Math.cos(above), Math.sin(above), Math.cos(around) * Math.cos(above)];
  const off = Math.hypot(...seenFrom(camera).map((value, axis) => value - told[axis]));
  visitor.check('first view', off < 1e-3, `the page opens from azimuth ${azimuth} and elevation ${elevation}, as the manifest says, but for ${off.toFixed(6)}`);
  await visitor.close(page, 'first view');
}

function framesInSecond(page) {
  return page.evaluate(async () => {
    let count = 0;
    const request = window.requestAnimationFrame;
    window.requestAnimationFrame = (draw) => (++count, request(draw));
    await new Promise((done) => setTimeout(done, 1000));
    window.requestAnimationFrame = request;
    return count;
  });
}

/// Once it is seen as fine as it gets, nothing is drawn.
async function checkRest(visitor, [name]) {
  const page = await visitor.open(anchor(name), { ...WIDE, restDetail: true });
  await settle(page);
  const counts = [];
  const rests = await until(page, async () => counts.push(await framesInSecond(page)) && counts.at(-1) === 0);
  visitor.check('rest', rests, `${counts.join(', ')} frames in a second`);
  const before = await picture(page);
  await loseDevice(page);
  await settle(page);
  page.complaints = page.complaints.filter((text) => !text.includes('Context'));
  visitor.check('context restored', before.equals(await picture(page)), 'the same picture');
  await visitor.close(page, 'rest');
}

// ---- code that is late, or never comes

const CODE = '**/assets/model_view-*.js';
const ROOT = '**/tiles/00/000000.glb';
const WORKER = '**/assets/tile_worker-*.js';

/// To a model, back, and to it again, before there is the code that draws it.
async function checkLateCode(visitor, [name]) {
  let release;
  const late = new Promise((done) => { release = done; });
  const page = await visitor.open('', { ...WIDE, routes: (one) => one.route(CODE, (route) => late.then(() => route.continue())) });
  const cell = page.locator('a.cell', { hasText: name }).first();
  await cell.click();
  await page.goBack();
  await cell.click();
  release();
  await settle(page);
  const views = await page.evaluate(() => document.querySelectorAll('main.view, canvas:not(.cell-outline)').length);
  visitor.check('late code', views === 2, 'one view, with one canvas');
  await visitor.close(page, 'late code');
}

/// To a model and back before its root is there: that is given up, and no failure.
async function checkLateRoot(visitor, [name]) {
  let release;
  const late = new Promise((done) => { release = done; });
  const forward = (route) => late.then(() => route.continue()).catch(() => undefined); // it was given up
  const page = await visitor.open('', { ...WIDE, routes: (one) => one.route(ROOT, forward) });
  let givenUp = false;
  page.on('requestfailed', (request) => { givenUp ||= request.url().endsWith('tiles/00/000000.glb'); });
  await page.locator('a.cell', { hasText: name }).first().click();
  await page.waitForFunction(() => window.meshhier.view !== null);
  await page.goBack();
  await page.locator('.gallery-header').waitFor();
  visitor.check('late root given up', await until(page, () => givenUp), 'with its model');
  release();
  await page.waitForTimeout(300); // for what should not be told
  visitor.check('late root', (await page.locator('.problem').count()) === 0, 'nothing is told');
  await page.locator('a.cell', { hasText: name }).first().click();
  await settle(page);
  await visitor.close(page, 'late root');
}

/// Timers wait until the address is the gallery's; then their time comes, before the page is told where the visitor is.
function holdTimers() {
  const { setTimeout, clearTimeout } = window;
  const held = new Map();
  let last = 0;
  window.setTimeout = (act) => {
    held.set(--last, act);
    return last;
  };
  window.clearTimeout = (timer) => held.delete(timer) || clearTimeout(timer);
  window.addEventListener('popstate', () => {
    if (location.hash !== '') return;
    Object.assign(window, { setTimeout, clearTimeout });
    for (const act of held.values()) act();
  });
}

/// Whether the gallery comes, at its own address.
async function comesToGallery(page) {
  return (await until(page, () => page.locator('.gallery-header').isVisible())) && !page.url().includes('#');
}

/// To a model and back; its camera comes to rest in between, when the address is the gallery's already.
async function checkLateRest(visitor, [name]) {
  const page = await visitor.open('');
  const cell = page.locator('a.cell', { hasText: name }).first();
  await cell.waitFor();
  await page.evaluate(holdTimers);
  await cell.click();
  await page.waitForFunction(() => window.meshhier.view !== null);
  await page.evaluate(() => new Promise((done) => { requestAnimationFrame(done); })); // the view's first frame was before
  await page.goBack();
  visitor.check('late rest', await comesToGallery(page), page.url());
  await visitor.close(page, 'late rest');
}

/// Escape twice, before the first has led anywhere; Escape from a model that was there before the gallery.
async function checkEscapes(visitor, [name]) {
  const page = await visitor.open('');
  await page.locator('a.cell', { hasText: name }).first().click();
  await settle(page);
  await page.evaluate(() => {
    const press = () => window.dispatchEvent(new KeyboardEvent('keydown', { key: 'Escape' }));
    setTimeout(() => [press(), press()]);
  });
  visitor.check('Escape twice', await comesToGallery(page), page.url());
  await visitor.close(page, 'Escape twice');
  const linked = await visitor.open(anchor(name));
  await settle(linked);
  await linked.keyboard.press('Escape');
  await comesToGallery(linked);
  await linked.goBack();
  await settle(linked);
  await linked.keyboard.press('Escape');
  visitor.check('Escape from a link again', await comesToGallery(linked), linked.url());
  await visitor.close(linked, 'Escape from a link again');
}

async function checkLostCode(visitor, [name]) {
  const page = await visitor.open('', { ...WIDE, routes: (one) => one.route(CODE, (route) => route.abort()) });
  await page.locator('a.cell', { hasText: name }).first().click();
  const told = page.getByRole('alert').locator('.problem');
  await told.waitFor();
  visitor.check('lost code', (await told.innerText()).includes(`${name} cannot be shown`), await told.innerText());
  await page.unroute(CODE);
  await page.locator('a.cell', { hasText: name }).first().click();
  await settle(page);
  visitor.check('lost code again', (await page.locator('.problem').count()) === 0, 'the model is shown');
  await page.close();
}

/// A worker whose script could not be had before anyone listened is not used.
async function checkLostWorker(visitor, [name]) {
  let asked = 0;
  const routes = async (page) => {
    await page.route(WORKER, (route) => (++asked === 1 ? route.abort() : route.continue()));
    await page.route(CODE, async (route) => {
      await new Promise((done) => setTimeout(done, 1000));
      await route.continue();
    });
  };
  const page = await visitor.open(anchor(name), { ...WIDE, routes });
  await settle(page);
  visitor.check('lost worker', asked > 1 && (await page.locator('.problem').count()) === 0, `${asked} requests, and the model is shown`);
  await page.close();
}

async function checkCamera(visitor, [name]) {
  const page = await visitor.open(anchor(name));
  await settle(page);
  const refusals = await page.evaluate(() => [NaN, 0].map((x) => {
    try {
      return window.meshhier.setCamera({ position: [x, 0, 0], target: [0, 0, 0] });
    } catch (error) {
      return `${error}`;
    }
  }));
  visitor.check('camera refused', refusals.every((text) => text?.startsWith('RangeError')), refusals.join('; '));
  await visitor.close(page, 'camera');
}

/// Without keys: a drag turns the light, and the link has it; then the camera again.
async function checkLight(visitor, [name]) {
  const page = await visitor.open(anchor(name), WIDE);
  await settle(page);
  await page.getByRole('button', { name: 'Look and settings', exact: true }).click();
  const drag = async () => {
    await page.mouse.move(100, 500);
    await page.mouse.down();
    await page.mouse.move(180, 440, { steps: 4 });
    await page.mouse.up();
  };
  const choice = page.getByRole('checkbox', { name: 'A drag turns the light' });
  const camera = () => page.evaluate(() => JSON.stringify(window.meshhier.camera()));
  const before = await camera();
  await choice.check();
  await drag();
  const isTurned = await until(page, () => /&light=auto,-?[\d.]+,-?[\d.]+$/.test(page.url()));
  const stays = (await camera()) === before;
  await choice.uncheck();
  await drag();
  const moves = await until(page, async () => (await camera()) !== before);
  visitor.check('light by a drag', isTurned && stays && moves, `${page.url().replace(/.*#/, '#')}; the camera ${stays ? 'stays, then' : 'moves, then'} ${moves ? 'moves' : 'stays'}`);
  await visitor.close(page, 'light');
}

/// Hollows get darker, nothing gets lighter, and the link has it.
async function checkOcclusion(visitor, [name], pictures) {
  const page = await visitor.open(anchor(name), WIDE);
  await settle(page);
  const bare = await picture(page);
  await press(page, 'a');
  await page.waitForFunction(() => location.hash.includes('&occlusion=on'));
  const shades = await until(page, async () => !bare.equals(await picture(page)));
  const shaded = await picture(page);
  await page.screenshot({ path: path.join(pictures, 'viewer-occlusion.png') });
  const { darker, lighter } = await comparePictures(page, bare, shaded);
  visitor.check('occlusion', shades && darker > 0.002 && darker < 0.5 && lighter === 0, `${(100 * darker).toFixed(2)} % of the picture darker, ${(100 * lighter).toFixed(2)} % lighter`);
  const again = await visitor.open(new URL(page.url()).hash, WIDE);
  await settle(again);
  visitor.check('occlusion in the link', await until(again, async () => shaded.equals(await picture(again))), new URL(page.url()).hash);
  await visitor.close(again, 'occlusion again');
  await press(page, 'a');
  visitor.check('occlusion off', await until(page, async () => bare.equals(await picture(page))), 'the picture is as it was');
  await visitor.close(page, 'occlusion');
}

// ---- narrow screens, and what can be heard

async function checkNarrow(visitor, [name], pictures) {
  for (const scheme of ['light', 'dark']) await checkNarrowIn(scheme, visitor, name, pictures);
}

async function checkNarrowIn(colorScheme, visitor, name, pictures) {
  const page = await visitor.open(anchor(name), { ...NARROW, colorScheme });
  await settle(page);
  for (const sheet of ['', 'Look and settings', 'Figures', 'Help']) {
    if (sheet !== '') await page.getByRole('button', { name: sheet, exact: true }).tap();
    const all = (await steady(page, () => targets(page))).filter(({ inSheet }) => !inSheet);
    const out = all.filter(({ left, top, right, bottom }) => left < 0 || top < 0 || right > 360 || bottom > 640);
    const small = all.filter(({ left, top, right, bottom }) => right - left < LEAST_TARGET || bottom - top < LEAST_TARGET);
    const over = all.filter((a, i) => all.slice(i + 1).some((b) => overlap(a, b)));
    const bad = [...out, ...small, ...over].map((one) => one.name);
    visitor.check(`360 x 640 ${colorScheme} ${sheet || 'view'}`, bad.length === 0, bad.join(', ') || `${all.length} controls in their places`);
    await page.screenshot({ path: path.join(pictures, `page-narrow-${colorScheme}-${sheet.split(' ')[0] || 'view'}.png`) });
  }
  await visitor.close(page, `narrow ${colorScheme}`);
}

async function checkNarrowGallery(visitor, names, pictures) {
  const page = await visitor.open('', { ...NARROW, colorScheme: 'dark' });
  await paintedCells(page, names);
  const width = await page.evaluate(() => document.documentElement.scrollWidth);
  visitor.check('360 x 640 gallery', width === 360, `${width} pixels wide`);
  await page.screenshot({ path: path.join(pictures, 'page-narrow-gallery.png') });
  await visitor.close(page, 'narrow gallery');
}

async function checkNames(visitor, [name]) {
  const page = await visitor.open(anchor(name));
  await settle(page);
  for (const control of ['Back', 'Whole model', 'Look and settings', 'Figures', 'Help', 'Closer', 'Farther'])
    visitor.check(`button ${control}`, await page.getByRole('button', { name: control, exact: true }).isVisible(), 'has its name');
  await page.getByRole('button', { name: 'Look and settings', exact: true }).press('Enter');
  visitor.check('radio Balanced', await page.getByRole('radio', { name: 'Balanced' }).isChecked(), 'is the quality');
  await page.getByText('Numbers', { exact: true }).click();
  for (const [role, control] of [['radio', 'Partitions'], ['checkbox', 'Wires'], ['slider', 'Frame rate to hold'], ['slider', 'Memory'], ['spinbutton', 'Error allowed (px)'], ['radio', 'Dark']])
    visitor.check(`${role} ${control}`, (await page.getByRole(role, { name: control }).count()) === 1, 'has its name');
  await page.getByRole('radio', { name: 'Dark' }).check();
  await page.keyboard.press('w');
  visitor.check('keys beside a choice', await page.evaluate(() => window.meshhier.view.look.wires), 'W shows the wires');
  await page.keyboard.press('w');
  visitor.check('theme', (await page.evaluate(() => document.documentElement.dataset.theme)) === 'dark', 'dark');
  await page.reload();
  await settle(page);
  visitor.check('theme kept', (await page.evaluate(() => document.documentElement.dataset.theme)) === 'dark', 'dark');
  await visitor.close(page, 'names');
}

// ---- what is missing

async function checkMissing(visitor, [name]) {
  const lost = await visitor.open('#models/nothing.hier');
  const alert = lost.getByRole('alert').locator('.problem').first();
  await alert.waitFor();
  visitor.check('missing model', (await alert.innerText()).includes('nothing cannot be opened'), await alert.innerText());
  await lost.getByRole('button', { name: 'Dismiss' }).click();
  visitor.check('missing model dismissed', (await lost.locator('.problem').count()) === 0, 'gone');
  await lost.close();
  const empty = await visitor.open('?models=nothing.json');
  await empty.locator('.gallery-note', { hasText: 'models.json' }).waitFor();
  visitor.check('missing listing', true, await empty.locator('.gallery-note').innerText());
  await empty.close();
  const alone = await visitor.open(`?model=models/${name}.hier`);
  await settle(alone);
  visitor.check('one model', !alone.asked.some((file) => file.startsWith('models.json')) && (await alone.getByRole('button', { name: 'Back' }).count()) === 0, 'without a listing');
  await visitor.close(alone, 'one model');
}

/// Addresses that no one can fetch, at first and after a model.
async function checkUnreachable(visitor, [name]) {
  for (const link of ['?model=ftp://x', '?models=ftp://x', '#ftp://x']) {
    const page = await visitor.open(link);
    const alert = page.getByRole('alert').locator('.problem');
    await alert.waitFor();
    visitor.check(`unreachable ${link}`, (await alert.innerText()).includes('ftp://x') && (await page.locator('.gallery').isVisible()), await alert.innerText());
    await visitor.close(page, `unreachable ${link}`);
  }
  const page = await visitor.open(anchor(name));
  await settle(page);
  await page.evaluate(() => { location.hash = '#ftp://x'; });
  await page.getByRole('alert').locator('.problem', { hasText: 'ftp://x' }).waitFor();
  await page.locator('a.cell', { hasText: name }).first().click();
  await settle(page);
  visitor.check('unreachable after a model', (await page.locator('.problem').count()) === 0, 'told, and gone with the next model');
  await visitor.close(page, 'unreachable after a model');
}

/// A host that is away for all tiles but the root: one message, which goes when they come.
async function checkTroubledTiles(visitor, [name]) {
  const finer = /\/tiles\/(?!00\/)/;
  const page = await visitor.open(anchor(name), { ...WIDE, routes: (one) => one.route(finer, (route) => route.abort()) });
  const problem = page.getByRole('alert').locator('.problem');
  await problem.filter({ hasText: /\d+ files are missing/ }).waitFor();
  const text = await problem.innerText();
  visitor.check('troubled tiles', (await problem.count()) === 1 && !/TypeError|CORS/.test(text), text);
  await page.unroute(finer);
  await page.evaluate(() => document.querySelector('.problem-retry')?.click()); // unless the view was faster
  await settle(page);
  visitor.check('troubled tiles again', await until(page, async () => (await problem.count()) === 0), 'all is there, and nothing is told');
  await page.close();
}

/// A root that is no tile, until it is one.
async function checkCorruptRoot(visitor, [name]) {
  const page = await visitor.open(anchor(name), { ...WIDE, routes: (one) => one.route(ROOT, (route) => route.fulfill({ body: 'no tile at all' })) });
  const problem = page.getByRole('alert').locator('.problem', { hasText: 'cannot be opened' });
  await problem.waitFor();
  const text = await problem.innerText();
  const more = await problem.locator('.problem-more').textContent();
  visitor.check('corrupt root', !/TypeError|CORS/.test(text + more) && more.includes('meshhier verify'), `${text} ${more}`);
  await page.unroute(ROOT);
  await problem.getByRole('button', { name: 'Retry' }).click();
  await settle(page);
  visitor.check('corrupt root again', (await problem.count()) === 0, 'the model is shown');
  await page.close();
}

/// A listing of an empty folder names it, and the inbox; a model that comes is shown without a visit more.
async function checkEmptyFolder(visitor, [name]) {
  let listing = { models: [], folder: '/data/models', inbox: '/data/inbox' };
  const page = await visitor.open('', { ...WIDE, routes: (one) => one.route('**/models.json*', (route) => route.fulfill({ json: listing })) });
  const note = page.locator('.gallery-note', { hasText: 'no hierarchies' });
  await note.waitFor();
  const text = await note.innerText();
  visitor.check('empty folder', text.includes('/data/models') && text.includes('/data/inbox'), text);
  listing = { models: [{ path: `models/${name}.hier` }] };
  await page.locator('a.cell', { hasText: name }).waitFor();
  visitor.check('empty folder filled', (await page.locator('.problem').count()) === 0, 'its model is shown');
  await page.close();
}

function withoutWebGl() {
  const get = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
    return kind === 'webgl2' ? null : get.call(this, kind, ...rest);
  };
}

async function checkWithoutWebGl(visitor, [name]) {
  const page = await visitor.open('', { ...WIDE, prepare: withoutWebGl });
  await page.locator('.cell-outline:visible').first().waitFor();
  visitor.check('gallery without WebGL 2', (await page.locator('.problem').count()) === 0, 'shows outlines');
  await page.locator('a.cell', { hasText: name }).first().click();
  const alert = page.getByRole('alert').locator('.problem');
  await alert.waitFor();
  const text = await alert.innerText();
  visitor.check('model without WebGL 2', text.includes('no WebGL 2') && (await page.locator('.gallery').isVisible()), text);
  await page.close();
}

async function checkAll(browser, report, pictures, hierarchies, origin) {
  const names = hierarchies.map(({ name }) => name);
  const visitor = new Visitor(browser, origin, report);
  await checkGallery(visitor, names, pictures);
  await checkModes(visitor, names[0], pictures);
  const others = [
    checkMotion, checkLongGallery, checkFolders, checkChangingListing, checkOutlineAgain, checkLinks, checkFirstView, checkRest, checkCamera, checkLight, checkOcclusion,
    checkLateCode, checkLateRoot, checkTroubledTiles, checkCorruptRoot, checkEmptyFolder, checkLateRest, checkEscapes, checkLostCode,
    checkLostWorker, checkNames, checkNarrowGallery, checkNarrow, checkMissing, checkUnreachable, checkWithoutWebGl];
  for (const check of inTurn(others)) await check(visitor, names, pictures);
}

async function serveAndCheck(browser, report, [pictures, page, ...directories]) {
  const hierarchies = directories.map(readHierarchy);
  await withSite(page, hierarchies, (origin) => checkAll(browser, report, pictures, hierarchies, origin), moreListings);
}

const [pictures, ...others] = process.argv.slice(2);
if (others.length < 2) {
  console.log('usage: node viewer_page.mjs PICTURES PAGE HIERARCHY...');
  process.exit(2);
}
process.exit(await inChromium(pictures, (browser, report) => serveAndCheck(browser, report, [pictures, ...others])));
