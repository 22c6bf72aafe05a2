// Checks objects in viewer/'s page in headless Chromium: picked by mouse and key, found by name, left out, and kept in links.
//
//   node objects.mjs PICTURES PAGE HIERARCHY
//
// PAGE: the directory that `npm run build` of viewer/ makes, dist/page. The hierarchy must have objects, some of them with a "/" in their
// names. Pictures go to the directory PICTURES. Exit code 2: wrong use; else see browser.mjs.
import path from 'node:path';
import { inChromium, readHierarchy, until, withoutRestDetail } from './browser.mjs';
import { withSite } from './site.mjs';

const VIEWPORT = { width: 1000, height: 700 };
const PATIENCE = 120_000; // milliseconds
const TRIES = 40; // places that are clicked until an object is there

class Visitor {
  constructor(browser, origin, report, { name, pictures }) {
    Object.assign(this, { browser, origin, report, name, pictures });
  }

  async open(choices = '') {
    const page = await this.browser.newPage({ reducedMotion: 'reduce', viewport: VIEWPORT });
    page.setDefaultTimeout(PATIENCE);
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
  await page.waitForFunction(() => window.meshhier?.settled(), null, { timeout: PATIENCE });
}

/// The name on the card; empty: there is no card, or nothing is picked.
async function pickedName(page) {
  const figures = page.locator('.tool-card:not([hidden]) .tool-figures dd');
  return (await figures.count()) > 0 ? figures.first().innerText() : '';
}

function nameIs(page, good) {
  return until(page, async () => good(await pickedName(page)));
}

/// Clicks here and there, beside the card, until an object with a name of parts is picked. Returns its place.
async function clickObject(page) {
  for (let i = 0; i < TRIES; ++i) {
    const place = { x: VIEWPORT.width * (0.66 + 0.22 * Math.sin(7 * i)), y: VIEWPORT.height * (0.5 + 0.2 * Math.cos(5 * i)) };
    await page.mouse.click(place.x, place.y);
    await page.waitForTimeout(700); // two taps are not one
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
  const marked = await page.screenshot(spot);
  await page.getByRole('application').focus();
  await page.keyboard.press('Backspace');
  visitor.check('mark', (await nameIs(page, (told) => told === '')) && !(await page.screenshot(spot)).equals(marked), 'the object has another colour');
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
  visitor.check('colours', await until(page, async () => page.url().includes('by=') && (await page.locator('.object-legend').innerText()) !== ''), await page.locator('.object-legend').innerText());
  await settle(page);
  await visitor.picture(page, 'colours');
  await checkLink(visitor, page, name);
  await button(page, 'Show everything').click();
  visitor.check('everything', await until(page, async () => !/hide=|only=/.test(page.url())), page.url().replace(/.*#/, ''));
  visitor.check('console', page.complaints.length === 0, page.complaints.join('; ') || 'no complaints');
  await page.close();
}

/// Whoever opens the page's address sees the same.
async function checkLink(visitor, page, name) {
  const other = await visitor.open(page.url().replace(/^.*\.hier/, ''));
  visitor.check('link', await nameIs(other, (told) => told === name), await pickedName(other));
  await settle(other);
  const clip = { x: VIEWPORT.width * 0.4, y: 150, width: VIEWPORT.width * 0.5, height: 450 }; // beside all buttons
  const [one, two] = await Promise.all([page, other].map((each) => each.screenshot({ clip })));
  await visitor.picture(other, 'link');
  visitor.check('picture of the link', one.equals(two), 'is the same');
  await other.close();
}

/// Turns until an object is in the middle, and takes it. False: none came there.
async function pickMiddle(page) {
  for (let i = 0; i < TRIES && (await pickedName(page)) === ''; ++i) {
    await page.keyboard.press(i % 2 === 0 ? 'ArrowRight' : 'ArrowUp');
    await settle(page);
    await page.keyboard.press('Enter');
    await page.waitForTimeout(700);
  }
  return (await pickedName(page)) !== '';
}

async function checkKeys(visitor) {
  const page = await visitor.open();
  await page.keyboard.press('j');
  await page.locator('.tool-card', { hasText: 'Objects' }).waitFor();
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

async function serveAndCheck(browser, report, [pictures, page, directory]) {
  const hierarchy = readHierarchy(directory);
  await withSite(page, [hierarchy], async (origin) => {
    const visitor = new Visitor(browser, origin, report, { name: hierarchy.name, pictures });
    await checkHand(visitor);
    await checkKeys(visitor);
  });
}

const given = process.argv.slice(2);
if (given.length !== 3) {
  console.log('usage: node objects.mjs PICTURES PAGE HIERARCHY');
  process.exit(2);
}
process.exit(await inChromium(given[0], (browser, report) => serveAndCheck(browser, report, given)));
