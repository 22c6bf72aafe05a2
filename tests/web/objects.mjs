// Checks objects in viewer/'s page in headless Chromium: picked by mouse and key, found by name and in a tree, left out of all that is drawn,
// and kept in links.
//
//   node objects.mjs PICTURES PAGE HIERARCHY
//
// PAGE: the directory that `npm run build` of viewer/ makes, dist/page. The hierarchy must have objects, some of them with a "/" in their
// names. Pictures go to the directory PICTURES. Exit code 2: wrong use; else see browser.mjs.
import path from 'node:path';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { decodePicture, inChromium, readHierarchy, until, withoutRestDetail } from './browser.mjs';
import { withSite } from './site.mjs';

const VIEWPORT = { width: 1000, height: 700 };
const CLIP = { x: VIEWPORT.width * 0.4, y: 150, width: VIEWPORT.width * 0.5, height: 450 }; // beside all buttons
const AXE = createRequire(import.meta.url).resolve('axe-core/axe.min.js');
const MARK = [255, 138, 31]; // the line around an object
const TRIES = 40; // places that are clicked until an object is there

class Visitor {
  constructor(browser, origin, report, { name, pictures }) {
    Object.assign(this, { browser, origin, report, name, pictures });
  }

  async open(choices = '') {
    const page = await this.browser.newPage({ reducedMotion: 'reduce', viewport: VIEWPORT });
    await page.addInitScript(withoutRestDetail);
    page.complaints = [];
    page.on('console', (message) => {
      if (['error', 'warning'].includes(message.type())) page.complaints.push(message.text());
    });
    page.on('pageerror', (error) => page.complaints.push(String(error)));
    await page.goto(`${this.origin}/index.html#models/${this.name}.hier${choices}`);
    await settle(page);
    return page;
  }

  check(what, good, text) {
    this.report.line(`objects ${what}`, good, text);
  }

  picture(page, what) {
    return page.screenshot({ path: path.join(this.pictures, `objects-${what}.png`) });
  }
}

async function settle(page) {
  await page.waitForFunction(() => window.meshhier?.settled());
}

/// The name on the card; empty: there is no card, or nothing is picked.
async function pickedName(page) {
  const figures = page.locator('.tool-card:not([hidden]) .tool-figures dd');
  return (await figures.count()) > 0 ? figures.first().innerText() : '';
}

function nameIs(page, good) {
  return until(page, async () => good(await pickedName(page)));
}

/// From now on `window.picks` counts those that have ended, whatever was there. The tool comes with the first tap, or by its key.
async function countPicks(page) {
  await page.waitForFunction(() => window.meshhier.view.plugins.named('page objects') !== undefined);
  await page.evaluate(() => {
    const objects = window.meshhier.view.plugins.named('page objects');
    const pick = objects.pick.bind(objects);
    window.picks = 0;
    objects.pick = (...place) => pick(...place).finally(() => { ++window.picks; });
  });
}

/// Picks by `act`, and waits for what comes of it. Two taps are not one.
async function pick(page, act) {
  await page.waitForTimeout(700);
  const before = await page.evaluate(() => window.picks);
  await act();
  await page.waitForFunction((count) => window.picks > count, before);
}

/// Clicks here and there, beside the card, until an object with a name of parts is picked. Returns its place.
async function clickObject(page) {
  const places = Array.from({ length: TRIES }, (_, i) => ({ x: VIEWPORT.width * (0.66 + 0.22 * Math.sin(7 * i)), y: VIEWPORT.height * (0.5 + 0.2 * Math.cos(5 * i)) }));
  await page.mouse.click(places[0].x, places[0].y);
  await countPicks(page);
  for (const place of places) {
    await pick(page, () => page.mouse.click(place.x, place.y));
    if ((await pickedName(page)).includes('/')) return place;
  }
  throw new Error('no object was picked');
}

function camera(page) {
  return page.evaluate(() => JSON.stringify(window.meshhier.camera()));
}

function button(page, name) {
  return page.locator('.tool-card').getByRole('button', { name, exact: true });
}

async function checkHand(visitor) {
  const page = await visitor.open();
  const place = await clickObject(page);
  const name = await pickedName(page);
  await visitor.picture(page, 'picked');
  const size = await page.locator('.tool-figures').innerText();
  const { clientWidth, scrollWidth } = await page.locator('.tool-card:not([hidden])').evaluate(({ clientWidth, scrollWidth }) => ({ clientWidth, scrollWidth }));
  visitor.check('card', scrollWidth <= clientWidth, `what is ${scrollWidth} wide is in a card of ${clientWidth}`);
  visitor.check('click', /Size\s/.test(size) && /Area/.test(size), size.replaceAll('\n', ' '));
  const spot = { clip: { x: place.x - 5, y: place.y - 5, width: 10, height: 10 } };
  await settle(page);
  const marked = await page.screenshot(spot);
  await page.getByRole('application').focus();
  await page.keyboard.press('Backspace');
  visitor.check('mark', (await nameIs(page, (told) => told === '')) && (await until(page, async () => !(await page.screenshot(spot)).equals(marked))), 'the object has another colour');
  await page.mouse.click(place.x, place.y);
  await nameIs(page, (told) => told === name);
  await page.waitForTimeout(700);
  const far = await camera(page);
  await page.mouse.dblclick(place.x, place.y);
  visitor.check('double click', await until(page, async () => (await camera(page)) !== far), 'the camera is at the object');
  await settle(page);
  await visitor.picture(page, 'near');
  await button(page, 'Hide').click();
  visitor.check('hidden in the link', await until(page, async () => page.url().includes(`hide=${encodeURIComponent(name)}`)), page.url().replace(/.*#/, ''));
  await settle(page);
  await visitor.picture(page, 'hidden');
  await page.locator('.object-acts select').selectOption({ index: 1 });
  const branch = await page.locator('.object-acts select').inputValue();
  await button(page, 'Show alone').click();
  visitor.check('alone in the link', await until(page, async () => page.url().includes(`only=${encodeURIComponent(branch)}`)), branch);
  await settle(page);
  await visitor.picture(page, 'alone');
  await page.locator('.object-legend').locator('..').locator('select').selectOption({ index: 1 });
  const ends = page.locator('.object-legend .ends input');
  visitor.check('colours', await until(page, async () => page.url().includes('by=') && (await ends.first().isVisible())), (await ends.evaluateAll((inputs) => inputs.map(({ value }) => value))).join(' to '));
  await ends.last().fill('20');
  await ends.last().press('Enter');
  visitor.check('range in the link', await until(page, async () => /between=[\d.]+,20(&|$)/.test(decodeURIComponent(page.url()))), page.url().replace(/.*&by/, 'by'));
  await settle(page);
  await visitor.picture(page, 'colours');
  await checkLink(visitor, page, name);
  await button(page, 'Show everything').click();
  visitor.check('everything', await until(page, async () => !/hide=|only=/.test(page.url())), page.url().replace(/.*#/, ''));
  visitor.check('console', page.complaints.length === 0, page.complaints.join('; ') || 'no complaints');
  await page.close();
}

function choicesOf(page) {
  return page.url().replace(/^.*?&(?=object=)/, '');
}

/// Whoever opens the page's address sees the same.
async function checkLink(visitor, page, name) {
  const other = await visitor.open(page.url().replace(/^.*\.hier/, ''));
  visitor.check('link', await nameIs(other, (told) => told === name), await pickedName(other));
  await other.locator('.object-legend .ends input').first().waitFor();
  await settle(other);
  visitor.check('choices of the link', await until(other, () => choicesOf(other) === choicesOf(page)), choicesOf(other));
  const [one, two] = await Promise.all([page, other].map((each) => each.screenshot({ clip: CLIP })));
  await visitor.picture(other, 'link');
  visitor.check('picture of the link', one.equals(two), 'is the same');
  await other.close();
}

/// Turns until an object is in the middle, and takes it. False: none came there.
async function pickMiddle(page) {
  for (let i = 0; i < TRIES && (await pickedName(page)) === ''; ++i) {
    await page.keyboard.press(i % 2 === 0 ? 'ArrowRight' : 'ArrowUp');
    await settle(page);
    await pick(page, () => page.keyboard.press('Enter'));
  }
  return (await pickedName(page)) !== '';
}

async function checkKeys(visitor) {
  const page = await visitor.open();
  await page.keyboard.press('j');
  await page.locator('.tool-card', { hasText: 'Objects' }).waitFor();
  await countPicks(page);
  visitor.check('key of the middle', await pickMiddle(page), await pickedName(page));
  const [first] = await page.evaluate(async () => (await window.meshhier.view.objects.rows({ begin: window.meshhier.view.objects.count - 1, end: window.meshhier.view.objects.count })).map(({ name }) => name));
  const field = page.getByRole('combobox', { name: 'Name of an object' });
  await field.focus();
  await page.keyboard.type(first.slice(0, -1));
  await page.getByRole('option').first().waitFor();
  await page.keyboard.press('ArrowDown');
  visitor.check('suggestion', (await field.getAttribute('aria-activedescendant')) === 'object-suggestion-0', await page.getByRole('option').first().innerText());
  await visitor.picture(page, 'suggestions');
  await page.keyboard.type(first.slice(-1));
  await until(page, async () => (await page.getByRole('option').allInnerTexts()).includes(first));
  await page.keyboard.press('Enter');
  visitor.check('name', await nameIs(page, (name) => name === first), await pickedName(page));
  await page.getByRole('application').focus();
  await page.keyboard.press('Backspace');
  visitor.check('back', await nameIs(page, (name) => name === ''), 'nothing is picked');
  visitor.check('console of keys', page.complaints.length === 0, page.complaints.join('; ') || 'no complaints');
  await page.close();
}

/// The first parts of all names.
function branches(page) {
  return page.evaluate(async () => {
    const { objects } = window.meshhier.view;
    const rows = await objects.rows({ begin: 0, end: objects.count });
    return [...new Set(rows.map(({ name }) => name.slice(0, name.indexOf('/') + 1)))];
  });
}

/// What is hidden has no wires, no points, and darkens nothing.
async function checkPasses(visitor) {
  const page = await visitor.open();
  const hidden = (await branches(page)).map((branch) => `&hide=${encodeURIComponent(branch)}`).join('');
  await page.close();
  const pictures = [];
  for (const besides of ['', '&occlusion=on&wires=on&points=on']) {
    const other = await visitor.open(`${besides}${hidden}`);
    await other.waitForFunction(() => window.meshhier.view.omits !== null);
    await settle(other);
    pictures.push(await other.screenshot({ clip: CLIP }));
    if (besides !== '') await visitor.picture(other, 'all-hidden');
    await other.close();
  }
  visitor.check('hidden in each pass', pictures[0].equals(pictures[1]), 'no wires, points or hollows are left');
}

async function markedPixels(page) {
  const pixels = await decodePicture(page, await page.screenshot({ clip: CLIP }));
  let marked = 0;
  for (let i = 0; i < pixels.length; i += 4) if (MARK.every((value, k) => Math.abs(pixels[i + k] - value) < 2)) ++marked;
  return marked;
}

/// Of an object that is cut in two what is left has a line around it.
async function checkCut(visitor) {
  const page = await visitor.open();
  await page.keyboard.press('j');
  const name = await page.evaluate(async () => (await window.meshhier.view.objects.row(window.meshhier.view.objects.count >> 1)).name);
  await page.getByRole('combobox', { name: 'Name of an object' }).fill(name);
  await page.getByRole('option', { name, exact: true }).waitFor();
  await page.keyboard.press('Enter');
  await nameIs(page, (told) => told === name);
  await settle(page);
  const whole = await markedPixels(page);
  await page.getByRole('application').focus();
  await page.keyboard.press('x');
  await page.getByRole('radio', { name: 'z', exact: true }).check({ force: true });
  let cut = whole;
  const isCut = await until(page, async () => {
    await settle(page);
    cut = await markedPixels(page);
    return cut > 50 && cut !== whole;
  });
  await visitor.picture(page, 'cut');
  visitor.check('line of a cut model', isCut, `${cut} pixels, of the whole object ${whole}`);
  await page.close();
}

function row(page, name) {
  return page.getByRole('treeitem', { name, exact: false }).first();
}

/// By keys alone.
async function checkTree(visitor) {
  const page = await visitor.open();
  await page.keyboard.press('j');
  const summary = page.locator('.object-browser summary');
  await summary.waitFor();
  await summary.focus();
  await page.keyboard.press('Enter');
  await page.getByRole('treeitem').nth(1).waitFor();
  await page.keyboard.press('Tab');
  const active = () => page.evaluate(() => {
    const { activeElement: one } = document;
    return Object.fromEntries(['role', 'aria-level', 'aria-expanded', 'aria-checked', 'aria-setsize'].map((name) => [name, one.getAttribute(name)]).concat([['text', one.querySelector('.tree-name')?.textContent]]));
  });
  const first = await active();
  visitor.check('tree', first.role === 'treeitem' && first['aria-level'] === '1' && first['aria-checked'] === 'true', JSON.stringify(first));
  while ((await active())['aria-expanded'] !== null) {
    await page.keyboard.press('ArrowRight');
    await page.locator('[role=treeitem][aria-busy]').waitFor({ state: 'detached' });
    await page.keyboard.press('ArrowDown');
  }
  const leaf = await active();
  visitor.check('tree leaf', Number(leaf['aria-level']) > 1 && Number(leaf['aria-setsize']) > 1, JSON.stringify(leaf));
  await page.keyboard.press(' ');
  visitor.check('tree hides', await until(page, async () => /hide=[^&]*%2F/.test(page.url()) && (await active())['aria-checked'] === 'false'), page.url().replace(/.*hier/, ''));
  await page.keyboard.press('ArrowLeft');
  visitor.check('tree parent', (await active())['aria-checked'] === 'mixed', JSON.stringify(await active()));
  await page.keyboard.press(' ');
  visitor.check('tree shows', await until(page, async () => !page.url().includes('hide=')), 'all of the branch again');
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('Enter');
  visitor.check('tree picks', await nameIs(page, (name) => name.endsWith(`/${leaf.text}`)), await pickedName(page));
  await visitor.picture(page, 'tree');
  await page.keyboard.press('End');
  await page.evaluate(readFileSync(AXE, 'utf8')); // the page's policy lets no foreign script in
  const { violations } = await page.evaluate(() => window.axe.run('.tool-card'));
  visitor.check('axe of the tree', violations.length === 0, violations.map(({ id, nodes }) => `${id}: ${nodes[0].failureSummary}`).join('; ') || 'finds nothing');
  const last = await page.evaluate(async () => (await window.meshhier.view.objects.row(window.meshhier.view.objects.count - 1)).name);
  await page.getByRole('combobox', { name: 'Name of an object' }).fill(last);
  await page.getByRole('option', { name: last, exact: true }).waitFor();
  await page.keyboard.press('Enter');
  visitor.check('tree follows', await until(page, async () => (await row(page, last.slice(last.lastIndexOf('/') + 1)).getAttribute('aria-selected').catch(() => null)) === 'true'), last);
  visitor.check('console of the tree', page.complaints.length === 0, page.complaints.join('; ') || 'no complaints');
  await page.close();
}

async function serveAndCheck(browser, report, [pictures, page, directory]) {
  const hierarchy = readHierarchy(directory);
  await withSite(page, [hierarchy], async (origin) => {
    const visitor = new Visitor(browser, origin, report, { name: hierarchy.name, pictures });
    for (const check of [checkHand, checkKeys, checkTree, checkPasses, checkCut]) await check(visitor);
  });
}

const given = process.argv.slice(2);
if (given.length !== 3) {
  console.log('usage: node objects.mjs PICTURES PAGE HIERARCHY');
  process.exit(2);
}
process.exit(await inChromium(given[0], (browser, report) => serveAndCheck(browser, report, given)));
