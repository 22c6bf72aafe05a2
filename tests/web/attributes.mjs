// A hierarchy with an attribute: the page colours it, keeps in its link how, and tells the value under the pointer; CesiumJS colours it by
// the metadata. In headless Chromium.
//
//   node attributes.mjs MESHHIER PICTURES PAGE MODELS NAME ATTRIBUTE
//
// MODELS: a directory with NAME.hier, of which ATTRIBUTE is a quantity. Exit code 2: wrong use; else see browser.mjs.
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { collectComplaints, decodePicture, inChromium, readHierarchy, SIZE, until } from './browser.mjs';
import { startServer } from './meshhier_server.mjs';
import { serve } from './server.mjs';
import { withSite } from './site.mjs';

const HERE = path.dirname(fileURLToPath(import.meta.url));
const ROOT = path.join(HERE, '../..');
const VIVID = 60; // a pixel's channels are so far apart
const LEAST_VIVID = 0.02; // of the picture

/// Which part of a picture has strong colours.
async function vividOf(decoder, picture) {
  const pixels = await decodePicture(decoder, picture);
  let vivid = 0;
  for (let i = 0; i < pixels.length; i += 4) {
    const channels = pixels.slice(i, i + 3);
    if (Math.max(...channels) - Math.min(...channels) > VIVID) ++vivid;
  }
  return vivid / (SIZE * SIZE);
}

async function openView(browser, address, complaints) {
  const page = await browser.newPage({ viewport: { width: SIZE, height: SIZE } });
  collectComplaints(page, complaints);
  await page.goto(address);
  await page.waitForFunction(() => window.meshhier?.settled());
  return page;
}

async function checkPage(browser, report, { decoder, pageDirectory, hierarchy, attribute, pictures }) {
  const complaints = [];
  await withSite(pageDirectory, [hierarchy], async (origin) => {
    const model = `${origin}/index.html#models/${hierarchy.name}.hier`;
    const shown = {};
    for (const [what, choices] of [['plain', '&colours=plain'], ['attribute', `&colours=attribute&attribute=${attribute}&ramp=turbo`], ['isolines', '&colours=attribute&ramp=turbo&isolines=on']]) {
      const page = await openView(browser, model + choices, complaints);
      const picture = await page.screenshot({ path: path.join(pictures, `attribute-${what}.png`) });
      shown[what] = { vivid: await vividOf(decoder, picture), picture };
      await page.close();
    }
    const { plain, attribute: coloured, isolines } = shown;
    report.line('page by attribute', plain.vivid < LEAST_VIVID && coloured.vivid >= LEAST_VIVID && !coloured.picture.equals(isolines.picture),
      `strong colours in ${(100 * plain.vivid).toFixed(1)} % of the plain picture, in ${(100 * coloured.vivid).toFixed(1)} % by the attribute; isolines are seen`);
    await checkForm(browser, report, `${model}&colours=attribute`, attribute, complaints);
  });
  report.line('page complaints', complaints.length === 0, complaints.join(' ') || 'none');
}

/// The settings' form changes the picture and the link.
async function checkForm(browser, report, address, attribute, complaints) {
  const page = await openView(browser, address, complaints);
  await page.getByRole('button', { name: 'Look and settings' }).or(page.getByRole('button', { name: 'Settings' })).first().click();
  const select = page.getByRole('combobox', { name: 'Attribute' });
  const options = await select.locator('option').allInnerTexts();
  await page.getByRole('radio', { name: 'turbo' }).check({ force: true });
  await page.getByRole('spinbutton', { name: 'To', exact: true }).fill('0.125');
  await page.getByRole('spinbutton', { name: 'To', exact: true }).press('Enter');
  await page.waitForFunction(() => /ramp=turbo/.test(location.hash) && /range=[^&]*,0\.125/.test(location.hash)).catch(() => undefined);
  const link = await page.evaluate(() => location.hash);
  report.line('page legend', options.includes(attribute) && /ramp=turbo/.test(link) && /range=[^&]*,0\.125/.test(link), `${options.join(', ')}; ${link}`);
  await page.close();
}

async function checkCesium(browser, report, { decoder, meshhier, models, hierarchy, attribute, pictures }) {
  const pages = await serve({
    '/examples/node_modules/meshoptimizer': path.join(ROOT, 'viewer/node_modules/meshoptimizer'),
    '/examples/node_modules': path.join(HERE, 'node_modules'),
    '/examples': path.join(ROOT, 'examples'),
  });
  const server = startServer(meshhier, models, '--cors', pages.origin);
  try {
    const address = `${pages.origin}/examples/cesium.html?url=${await server.url}models/${hierarchy.name}.hier&attribute=`;
    const page = await browser.newPage({ viewport: { width: SIZE, height: SIZE } });
    await page.goto(address + attribute);
    let vivid = 0;
    await until(page, async () => {
      vivid = await vividOf(decoder, await page.screenshot({ path: path.join(pictures, 'attribute-cesium.png') }));
      return vivid >= LEAST_VIVID;
    });
    const message = await page.locator('#message').innerText();
    report.line('cesium by attribute', vivid >= LEAST_VIVID && message === '', `strong colours in ${(100 * vivid).toFixed(1)} % ${message}`);
    await page.goto(`${address}nothing`);
    const said = page.locator('#message', { hasText: `no attribute nothing, but ${attribute}` });
    report.line('cesium without it', await said.waitFor().then(() => true, () => false), await page.locator('#message').innerText());
    await page.close();
  } finally {
    await server.stop();
    pages.close();
  }
}

const [meshhier, pictures, pageDirectory, models, name, attribute] = process.argv.slice(2);
if (attribute === undefined) {
  console.log('usage: node attributes.mjs MESHHIER PICTURES PAGE MODELS NAME ATTRIBUTE');
  process.exit(2);
}
process.exit(await inChromium(pictures, async (browser, report) => {
  const decoder = await browser.newPage();
  const hierarchy = readHierarchy(path.join(models, `${name}.hier`));
  await checkPage(browser, report, { decoder, pageDirectory, hierarchy, attribute, pictures });
  await checkCesium(browser, report, { decoder, meshhier, models, hierarchy, attribute, pictures });
}));
