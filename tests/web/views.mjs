// Checks in headless Chromium that a link carries the view, in the page and in the element: cut, box, measured points, picked point, level, an
// attribute with its range and tolerance come back from a link, which is the same then, and so is the picture; and that a model opens as its
// manifest says.
//
//   node views.mjs PICTURES PAGE HIERARCHY ATTRIBUTE
//
// PAGE: the directory that `npm run build` of viewer/ makes, dist/page. HIERARCHY: closed, with some partitions; ATTRIBUTE: a quantity of its
// vertices around 0. Pictures go to the directory PICTURES. Exit code 2: wrong use; else see browser.mjs.
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { addStyle, collectComplaints, comparePictures, inChromium, readHierarchy, steady, until, withoutRestDetail } from './browser.mjs';
import { withSite } from './site.mjs';

const WIDE = { viewport: { width: 900, height: 640 }, reducedMotion: 'reduce' };
const NARROW = { viewport: { width: 360, height: 640 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true, reducedMotion: 'reduce' };
const LEAST_VIVID = 0.01; // of the picture
const MOST_APART = 0.00005; // of the picture: on a busy machine 3 pixels of a cut differed, on an idle one none

async function settle(page) {
  await page.waitForFunction(() => window.meshhier?.settled());
}

async function open(browser, address, complaints, options = WIDE) {
  const page = await browser.newPage(options);
  collectComplaints(page, complaints);
  await page.addInitScript(withoutRestDetail);
  await page.goto(address);
  await settle(page);
  return page;
}

/// To a page without a script and an icon: the model's address again would change the hash alone.
async function leave(page, origin) {
  await page.route('**/favicon.ico', (route) => route.fulfill({ status: 204 }));
  await page.goto(`${origin}/models.json`);
}

/// The model and its marks, without bars and cards.
async function bareScreenshot(page, file) {
  const takeAway = await addStyle(page, '.top-bar, .bar, .busy, .tools, .tool-lasting, .view-legend { visibility: hidden !important }');
  await settle(page);
  const picture = await steady(page, () => page.screenshot({ path: file }));
  await takeAway();
  return picture;
}

/// What the page's address becomes once the view rests.
async function linkOf(page) {
  await page.getByRole('button', { name: 'Share', exact: true }).click();
  const link = await page.getByRole('textbox', { name: 'Link to this view' }).inputValue();
  await page.getByRole('button', { name: 'Share', exact: true }).click();
  return link;
}

function choicesOf(link) {
  return Object.fromEntries(new URLSearchParams(new URL(link).hash.split('&').filter((part) => part.includes('=')).join('&')));
}

/// Coordinates within the model's box, at a part of the way along each axis.
function placeIn({ min, max }, ...parts) {
  return parts.map((part, axis) => Number((min[axis] + part * (max[axis] - min[axis])).toPrecision(6)));
}

function linksOf(bounds, attribute) {
  const [a, b, c] = [placeIn(bounds, 0.2, 0.5, 0.5), placeIn(bounds, 0.8, 0.5, 0.4), placeIn(bounds, 0.5, 0.9, 0.6)];
  const [low, high] = [placeIn(bounds, 0.1, 0.1, 0.1), placeIn(bounds, 0.9, 0.9, 0.7)];
  const coloured = `colours=attribute&attribute=${attribute}&ramp=coolwarm&range=-0.02,0.02&tolerance=0.005&light=flat`;
  return {
    cut: `${coloured}&level=1&cut=0,0,1,${-c[2]}&measure=${[a, b, c].flat()}&pick=${a}`,
    box: `cavities=off&light=studio,0.5,0.25&occlusion=on&box=${[...low, ...high]}&caps=off&measure=${[a, b].flat()}`,
    slanted: `up=z&cut=0.6,0,0.8,0.01`,
  };
}

async function checkLink(browser, report, origin, { name, link, what, pictures, complaints, decoder }) {
  const address = `${origin}/index.html#models/${name}.hier&${link}`;
  const page = await open(browser, address, complaints);
  const count = (choicesOf(address).measure ?? '').split(',').length / 3;
  if (count >= 1) await until(page, async () => (await page.locator('.tool-overlay circle').count()) >= count);
  if (link.includes('cut=') || link.includes('box=')) await page.locator('.tool-lasting:not([hidden])').waitFor();
  await settle(page);
  const before = await linkOf(page);
  const [asked, told] = [choicesOf(address), choicesOf(before)];
  const others = Object.keys(asked).filter((key) => key !== 'pick' && asked[key] !== told[key]);
  report.line(`${what} link`, others.length === 0, others.map((key) => `${key}: ${asked[key]} became ${told[key]}`).join('; ') || 'says what was asked for');
  if ('level' in asked) report.line(`${what} level`, await page.evaluate((most) => window.meshhier.stats().finestLevel <= most, Number(asked.level)), `${await page.evaluate(() => window.meshhier.stats().finestLevel)}`);
  const one = await bareScreenshot(page, path.join(pictures, `views-${what}.png`));
  await page.close();
  const again = await open(browser, before, complaints);
  if (count >= 1) await until(again, async () => (await again.locator('.tool-overlay circle').count()) >= count);
  if (link.includes('cut=') || link.includes('box=')) await again.locator('.tool-lasting:not([hidden])').waitFor();
  const other = await bareScreenshot(again, path.join(pictures, `views-${what}-again.png`));
  const { darker, lighter } = await comparePictures(decoder, one, other);
  report.line(`${what} again`, (await linkOf(again)) === before && darker + lighter <= MOST_APART, `the same link; ${Math.round((darker + lighter) * WIDE.viewport.width * WIDE.viewport.height)} pixels differ`);
  await again.close();
}

/// Another link while the page is open, and the way back.
async function checkBack(browser, report, origin, { name, links, complaints }) {
  const model = `${origin}/index.html#models/${name}.hier`;
  const page = await open(browser, `${model}&${links.cut}`, complaints);
  const marks = () => page.locator('.tool-overlay circle').count();
  const isCut = () => page.evaluate(() => window.meshhier.view.plugins.cuts.length);
  await until(page, async () => (await marks()) >= 3);
  await page.evaluate((hash) => { location.hash = hash; }, `#models/${name}.hier&${links.box}`);
  report.line('another link', (await until(page, async () => (await isCut()) === 6)) && (await until(page, async () => (await marks()) === 2)), `${await isCut()} planes, ${await marks()} points`);
  await page.goBack();
  report.line('back', (await until(page, async () => (await isCut()) === 1)) && (await until(page, async () => (await marks()) >= 3)), `${await isCut()} plane, ${await marks()} points`);
  await page.evaluate((hash) => { location.hash = hash; }, `#models/${name}.hier`);
  report.line('a bare link', (await until(page, async () => (await isCut()) === 0)) && (await until(page, async () => (await marks()) === 0)), 'whole again, without points');
  await page.close();
}

/// A copy of a hierarchy whose manifest says how it is seen first.
function withView(hierarchy, view, use) {
  const folder = mkdtempSync(path.join(tmpdir(), 'meshhier-view-'));
  const directory = path.join(folder, `${hierarchy.name}.hier`);
  cpSync(hierarchy.directory, directory, { recursive: true });
  const file = path.join(directory, 'hierarchy.json');
  writeFileSync(file, JSON.stringify({ ...JSON.parse(readFileSync(file, 'utf8')), units: 'mm', view })); // viewers take its checksum as a name
  return use({ ...hierarchy, directory }).finally(() => { rmSync(folder, { recursive: true }); });
}

async function vividOf(decoder, picture) {
  return decoder.evaluate(async (data) => {
    const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
    context.drawImage(bitmap, 0, 0);
    const { data: pixels } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    let vivid = 0;
    for (let i = 0; i < pixels.length; i += 4) if (Math.max(pixels[i], pixels[i + 1], pixels[i + 2]) - Math.min(pixels[i], pixels[i + 1], pixels[i + 2]) > 60) ++vivid;
    return vivid / (pixels.length / 4);
  }, picture.toString('base64'));
}

async function checkFirst(browser, report, origin, { name, view, complaints, pictures, decoder }) {
  const model = `${origin}/index.html#models/${name}.hier`;
  for (const [form, options] of [['wide', WIDE], ['narrow', NARROW]]) {
    const page = await open(browser, model, complaints, options);
    await page.locator('.view-legend').waitFor();
    const vivid = await vividOf(decoder, await steady(page, () => page.screenshot({ path: path.join(pictures, `views-first-${form}.png`) })));
    const legend = await page.locator('.view-legend').innerText();
    report.line(`first view ${form}`, vivid >= LEAST_VIVID && legend.includes(`${view.attribute}, mm`) && legend.includes('± 0.005 mm'), `${(100 * vivid).toFixed(1)} % vivid; ${legend.replace(/\s+/g, ' ')}`);
    await page.close();
  }
  const page = await open(browser, model, complaints);
  await page.locator('.view-legend').waitFor();
  const camera = () => page.evaluate(() => { const { position, target } = window.meshhier.camera(); return [...position, ...target]; });
  report.line('first camera', JSON.stringify(await camera()) === JSON.stringify(view.camera), String(await camera()));
  await checkLegend(report, page, pictures);
  await page.locator('.surface').focus();
  await page.keyboard.press('1');
  await page.keyboard.press('ArrowLeft');
  await settle(page);
  const own = await linkOf(page);
  report.line('own colours', own.includes('colours=plain') && (await page.locator('.view-legend').isHidden()), own);
  await page.evaluate(() => { localStorage.setItem('meshhier', JSON.stringify({ look: { colours: 'partition', wires: true } })); });
  await leave(page, origin);
  await page.goto(model);
  await settle(page);
  report.line('first view before the browser', await until(page, () => page.evaluate(() => { const { colours, wires } = window.meshhier.view.look; return colours === 'attribute' && !wires; })), JSON.stringify(await page.evaluate(() => window.meshhier.view.look)));
  await leave(page, origin);
  await page.goto(`${model}&colours=height`);
  await settle(page);
  report.line('link before the first view', (await page.evaluate(() => window.meshhier.view.look.colours)) === 'height', 'by height');
  await page.evaluate(() => { window.meshhier.setCamera({ position: [9, 9, 9], target: [0, 0, 0] }); });
  await page.getByRole('button', { name: 'Look and settings' }).click();
  await page.getByRole('button', { name: 'As the model opens' }).click();
  report.line('reset', await until(page, async () => (await page.evaluate(() => window.meshhier.view.look.colours)) === 'attribute' && JSON.stringify(await camera()) === JSON.stringify(view.camera)), String(await camera()));
  await checkLines(report, page, view);
  await page.close();
}

/// An end is dragged, and moved by keys: the other one goes along.
async function checkLegend(report, page, pictures) {
  const range = () => page.evaluate(() => window.meshhier.view.look.range);
  const { x, y, width, height } = await page.locator('.view-legend .legend-plot').boundingBox();
  await page.mouse.move(x + width - 2, y + height / 2);
  await page.mouse.down();
  await page.mouse.move(x + 0.7 * width, y + height / 2, { steps: 4 });
  await page.mouse.up();
  const [low, high] = await range();
  report.line('legend dragged', low === -high && high > 0 && high < 0.02, `${low}, ${high}`);
  await page.locator('.view-legend').getByRole('slider', { name: 'To' }).focus();
  await page.keyboard.press('ArrowLeft');
  const [, next] = await range();
  report.line('legend by key', next < high, String(next));
  await page.screenshot({ path: path.join(pictures, 'views-legend.png') });
}

/// Who may not write has lines to paste.
async function checkLines(report, page, view) {
  await page.getByRole('button', { name: 'Share', exact: true }).click();
  await page.getByText('First view for everybody').click();
  const line = await page.getByRole('textbox', { name: 'Line for the config' }).inputValue();
  const command = await page.getByRole('textbox', { name: 'Command' }).inputValue();
  const said = JSON.parse(`{${line}}`).view;
  const keys = Object.keys(view).filter((key) => JSON.stringify(said[key]) !== JSON.stringify(view[key]));
  report.line('lines to paste', keys.length === 0 && command.startsWith('meshhier view') && command.includes(`attribute=${view.attribute}`), `${line}; ${command}`);
}

/// The element shows the same as the page: by its attribute, and as its model is seen first.
async function checkElement(browser, report, origin, { name, link, complaints, pictures, decoder }) {
  const { width, height } = WIDE.viewport;
  const shown = {};
  for (const [what, view] of [['attribute', ` view="${link.replaceAll('&', '&amp;')}"`], ['first', '']]) {
    const page = await browser.newPage(WIDE);
    collectComplaints(page, complaints);
    const body = `<!doctype html><link rel="icon" href="data:,"><title>host</title><style>body { margin: 0 }</style><script type="module" src="meshhier-viewer.js"></script><meshhier-viewer src="models/${name}.hier"${view} style="width: ${width}px; height: ${height}px"></meshhier-viewer>`;
    await page.route('**/host.html', (route) => route.fulfill({ contentType: 'text/html', body }));
    await page.goto(`${origin}/host.html`);
    await page.waitForFunction(() => document.querySelector('meshhier-viewer').view?.stats().settled);
    if (what === 'attribute') await until(page, () => page.evaluate(() => document.querySelector('meshhier-viewer').view.plugins.cuts.length > 0));
    const picture = await steady(page, () => page.screenshot({ path: path.join(pictures, `views-element-${what}.png`) }));
    shown[what] = await page.evaluate(() => {
      const { view, camera } = document.querySelector('meshhier-viewer');
      return { cuts: view.plugins.cuts.length, colours: view.look.colours, level: view.mostLevel, camera };
    });
    shown[what].vivid = await vividOf(decoder, picture);
    await page.close();
  }
  report.line('element by its attribute', shown.attribute.cuts === 1 && shown.attribute.colours === 'attribute' && shown.attribute.level === 1, JSON.stringify(shown.attribute));
  report.line('element at first', shown.first.cuts === 0 && shown.first.colours === 'attribute' && shown.first.vivid >= LEAST_VIVID, JSON.stringify(shown.first));
}

const [pictures, pageDirectory, directory, attribute] = process.argv.slice(2);
if (attribute === undefined) {
  console.log('usage: node views.mjs PICTURES PAGE HIERARCHY ATTRIBUTE');
  process.exit(2);
}
process.exit(await inChromium(pictures, async (browser, report) => {
  const decoder = await browser.newPage();
  const hierarchy = readHierarchy(directory);
  const { bounds } = JSON.parse(readFileSync(path.join(directory, 'hierarchy.json'), 'utf8')).source;
  const links = linksOf(bounds, attribute);
  const complaints = [];
  await withSite(pageDirectory, [hierarchy], async (origin) => {
    for (const [what, link] of Object.entries(links)) await checkLink(browser, report, origin, { name: hierarchy.name, link, what, pictures, complaints, decoder });
    await checkBack(browser, report, origin, { name: hierarchy.name, links, complaints });
  });
  const view = { camera: [1, 2, 4, 0.25, 0, 0], colours: 'attribute', attribute, ramp: 'coolwarm', range: [-0.02, 0.02], tolerance: 0.005, light: 'studio' };
  await withView(hierarchy, view, (seen) => withSite(pageDirectory, [seen], async (origin) => {
    await checkFirst(browser, report, origin, { name: hierarchy.name, view, complaints, pictures, decoder });
    await checkElement(browser, report, origin, { name: hierarchy.name, link: links.cut, complaints, pictures, decoder });
  }));
  report.line('views console', complaints.length === 0, complaints.join('; ') || 'no errors');
}));
