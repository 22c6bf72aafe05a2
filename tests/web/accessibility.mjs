// Whether the page is there for everyone: axe-core finds nothing in gallery and view, in both themes, with each sheet open; the
// keyboard reaches every control, and its focus can be seen. In headless Chromium.
//
//   node accessibility.mjs PICTURES PAGE HIERARCHY
//
// PAGE: the directory that `npm run build` of viewer/ makes, dist/page. Exit code 2: wrong use; else see browser.mjs.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { inChromium, readHierarchy } from './browser.mjs';
import { withSite } from './site.mjs';

const AXE = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const RULES = ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice'];
const WINDOW = { viewport: { width: 1100, height: 760 }, reducedMotion: 'reduce' };
const MOST_TABS = 60;
const LEAST_PASSED = 15; // rules that apply at least
const JOBS = [
  { name: 'half.ply', state: 'building', stage: 'simplify', progress: 0.5, seconds_left: 90 },
  { name: 'bad.ply', state: 'failed', message: 'bad.ply: byte 7: not a number' },
];

/// The same model below two folders, with jobs.
function moreListings([{ path, ...model }]) {
  return { 'all.json': { models: ['', 'a/../'].map((folder) => ({ ...model, path: `${folder}${path}` })), jobs: JOBS } };
}

async function open(browser, address, options) {
  const page = await browser.newPage({ ...WINDOW, ...options });
  await page.goto(address);
  await page.evaluate(AXE); // the page's policy lets no foreign script in
  return page;
}

/// Lists what axe-core finds, in a line each.
async function findings(page) {
  const { violations, passes } = await page.evaluate((values) => window.axe.run({ runOnly: { type: 'tag', values } }), RULES);
  if (passes.length < LEAST_PASSED) return [`only ${passes.length} rules were checked`];
  return violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ target, failureSummary }) => `${target} (${failureSummary.split('\n').at(-1).trim()})`).join(', ')}`);
}

async function check(report, page, what) {
  const found = await findings(page);
  report.line(`axe ${what}`, found.length === 0, found.join('; ') || 'finds nothing');
}

/// Goes through the page by Tab until the focus comes round: what it meets, and what shows no focus.
async function walk(page) {
  const [met, unseen] = [new Set(), []];
  for (let i = 0; i < MOST_TABS; ++i) {
    await page.keyboard.press('Tab');
    const { name, seen, last } = await page.evaluate(() => {
      const one = document.activeElement;
      if (one === document.body) return { name: null, seen: true, last: false }; // between the last control and the first
      const shown = [one, one.nextElementSibling].some((each) => each !== null && getComputedStyle(each).outlineStyle !== 'none');
      const again = one.dataset.walked !== undefined;
      one.dataset.walked = '';
      return { name: one.getAttribute('aria-label') ?? one.labels?.[0]?.textContent ?? one.textContent, seen: shown, last: again };
    });
    if (last) break;
    if (name !== null) met.add(name);
    if (!seen) unseen.push(name);
  }
  return { met: [...met], unseen };
}

/// Controls that Tab has not met; of a group of radio buttons one is enough.
function unmet(page) {
  return page.evaluate(() => [...document.querySelectorAll('button, a[href], input, select, textarea, [tabindex="0"]')]
    .filter((one) => one.checkVisibility({ visibilityProperty: true }) && one.dataset.walked === undefined)
    .filter((one) => !(one.type === 'radio' && document.querySelector(`input[name="${one.name}"][data-walked]`)))
    .map((one) => one.getAttribute('aria-label') ?? one.textContent));
}

async function checkKeys(report, page, what) {
  const { met, unseen } = await walk(page);
  const missed = await unmet(page);
  report.line(`keyboard ${what}`, missed.length === 0 && met.length > 3, missed.join(', ') || `reaches ${met.length} controls`);
  report.line(`focus ${what}`, unseen.length === 0, unseen.join(', ') || 'can be seen');
}

async function checkGallery(browser, report, origin, colorScheme) {
  const page = await open(browser, `${origin}/index.html?models=all.json`, { colorScheme });
  await page.locator('a.cell').first().waitFor();
  await page.waitForFunction(() => document.querySelector('.cell-stage.waiting') === null);
  await check(report, page, `gallery ${colorScheme}`);
  await checkKeys(report, page, `gallery ${colorScheme}`);
  await page.close();
}

async function checkView(browser, report, origin, { name }, colorScheme) {
  const page = await open(browser, `${origin}/index.html#models/${name}.hier`, { colorScheme });
  await page.waitForFunction(() => window.meshhier.settled());
  await check(report, page, `view ${colorScheme}`);
  for (const button of await page.locator('button[aria-controls]').all()) {
    await button.click();
    await check(report, page, `${await button.getAttribute('aria-label')} ${colorScheme}`);
    await checkKeys(report, page, `${await button.getAttribute('aria-label')} ${colorScheme}`);
    await page.evaluate(() => document.querySelectorAll('[data-walked]').forEach((one) => { delete one.dataset.walked; }));
    await button.click();
  }
  const summary = await page.getByRole('application').evaluate((one) => document.getElementById(one.getAttribute('aria-describedby')).textContent);
  report.line(`summary ${colorScheme}`, /triangles/.test(summary), summary);
  await page.close();
}

async function checkProblem(browser, report, origin, colorScheme) {
  const page = await open(browser, `${origin}/index.html#models/nothing.hier`, { colorScheme });
  await page.getByRole('alert').locator('.problem').waitFor();
  await check(report, page, `problem ${colorScheme}`);
  const text = page.locator('.problem-text');
  report.line(`problem ${colorScheme} in a line`, (await text.boundingBox()).height < 45, await text.innerText());
  report.line(`problem ${colorScheme} again`, await page.getByRole('button', { name: 'Retry' }).isVisible(), 'Retry');
  await page.close();
}

async function checkAll(browser, report, [, pageDirectory, directory]) {
  const hierarchy = readHierarchy(directory);
  await withSite(pageDirectory, [hierarchy], async (origin) => {
    for (const scheme of ['light', 'dark']) {
      await checkGallery(browser, report, origin, scheme);
      await checkView(browser, report, origin, hierarchy, scheme);
      await checkProblem(browser, report, origin, scheme);
    }
  }, moreListings);
}

const parameters = process.argv.slice(2);
if (parameters.length !== 3) {
  console.log('usage: node accessibility.mjs PICTURES PAGE HIERARCHY');
  process.exit(2);
}
process.exit(await inChromium(parameters[0], (browser, report) => checkAll(browser, report, parameters)));
