// Uses the viewer's page at random in headless Chromium: keys, clicks, drags, turns of the wheel, and buttons. Nothing may reach the console.
//
//   node random_use.mjs PICTURES PAGE ACTS HIERARCHY...
//
// PAGE: the directory that `npm run build` of viewer/ makes, dist/page. Each hierarchy is used for that many acts. What is done is chosen by
// the same numbers each time. With the model open afresh the page must not hold more and more. A picture of the end goes to the
// directory PICTURES. Exit code 2: wrong use; else see browser.mjs.
import path from 'node:path';
import { collectComplaints, inChromium, PATIENCE, readHierarchy } from './browser.mjs';
import { random } from './random.mjs';
import { withSite } from './site.mjs';

const VIEWPORT = { width: 480, height: 360 };
const BURST = 8; // acts at once: the page has no time to rest
const DRAG_PATIENCE = 10_000; // milliseconds
const KEYS = [...'abcdefghijklmnopqrstuvwxyz0123456789+-?', 'Enter', 'Escape', 'Backspace', 'Delete', 'Tab', ' ', 'Home',
  'ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', 'Shift+ArrowLeft', 'Shift+Tab'];
const ACTS = ['key', 'key', 'key', 'tool', 'tool', 'click', 'drag', 'wheel', 'control', 'control'];
const TOOLS = ['i', 'm', 'x', 'n', 'k'];

const EARLY = 0.4; // of the acts: by then the code of most tools is there
/// So much may be held later beside what was held early.
const MORE = { heap: { factor: 1.3, some: 6e6 }, nodes: { factor: 1.5, some: 1000 }, listeners: { factor: 1.5, some: 150 } };

class Hand {
  constructor(page, seed) {
    Object.assign(this, { page, next: random(seed), done: 0, doing: new Set() });
  }

  one(list) {
    return list[Math.floor(this.next() * list.length)];
  }

  place() {
    return [this.next() * VIEWPORT.width, this.next() * VIEWPORT.height];
  }

  async key() {
    await this.page.keyboard.press(this.one(KEYS));
  }

  async tool() {
    await this.page.keyboard.press(this.one(TOOLS));
    await this.page.mouse.click(...this.place());
    await this.page.keyboard.press('Enter');
  }

  async click() {
    await this.page.mouse.click(...this.place());
  }

  /// Other acts move the same pointer meanwhile, and the driver may wait for a move that never comes. Then the drag is left alone;
  /// the frame after the burst shows whether the page lives.
  async drag() {
    const dragged = this.dragged();
    dragged.catch(() => undefined); // when it is left alone
    let timer;
    const late = new Promise((resolve) => { timer = setTimeout(resolve, DRAG_PATIENCE); });
    await Promise.race([dragged, late]).finally(() => { clearTimeout(timer); });
  }

  async dragged() {
    await this.page.mouse.move(...this.place());
    await this.page.mouse.down({ button: this.one(['left', 'left', 'right']) });
    for (let i = 0; i < 3; ++i) await this.page.mouse.move(...this.place());
    await this.page.mouse.up({ button: 'left' });
    await this.page.mouse.up({ button: 'right' });
  }

  /// The browser's answer to a turn of the wheel is not waited for: it is lost where what would scroll goes away before.
  async wheel() {
    await this.page.mouse.move(...this.place());
    this.page.mouse.wheel(0, 800 * (this.next() - 0.5)).catch(() => undefined);
  }

  /// A button, a choice, or a slider that is there, whatever lies over it.
  async control() {
    await this.evaluate((part) => {
      const all = [...document.querySelectorAll('button, input, select, summary')].filter((one) => one.checkVisibility() && one.type !== 'file');
      const one = all[Math.floor(part * all.length)];
      if (one === undefined) return;
      if (one.type === 'range' || one.type === 'number') one.value = String(Math.min(Number(one.min) + part * (Number(one.max) - Number(one.min)), 1000)); // larger pictures take long
      else if (one instanceof HTMLSelectElement) one.selectedIndex = Math.floor(part * 97) % one.options.length;
      else one.click();
      for (const type of ['input', 'change']) if (!(one instanceof HTMLButtonElement)) one.dispatchEvent(new Event(type, { bubbles: true }));
    }, this.next());
  }

  async act(name = this.one(ACTS)) {
    const doing = { name };
    this.doing.add(doing);
    await this[name]().catch((error) => {
      if (!String(error).includes('Internal error')) throw error; // the browser's, where the page goes away under the pointer
    });
    this.doing.delete(doing);
    ++this.done;
  }

  async frame() {
    await this.evaluate(() => new Promise((done) => { requestAnimationFrame(done); }));
  }

  /// Another act may lead to another page before the answer is there.
  async evaluate(asked, argument) {
    await this.page.evaluate(asked, argument).catch((error) => {
      if (!String(error).includes('navigation')) throw error;
      return this.page.waitForLoadState();
    });
  }

  /// Several acts at once, and a frame after them. Throws where the page does not come back from them: input has no patience
  /// of its own.
  async burst() {
    const acts = Promise.all(Array.from({ length: BURST }, () => this.act())).then(() => this.act('frame'));
    acts.catch(() => undefined);
    let timer;
    const late = new Promise((_, reject) => {
      timer = setTimeout(() => { reject(new Error(`after ${this.done} acts these do not end: ${[...this.doing].map(({ name }) => name)}`)); }, PATIENCE);
    });
    await Promise.race([acts, late]).finally(() => { clearTimeout(timer); });
  }
}

/// An earlier step may still lead to another page.
async function opened(page, address) {
  for (let interrupted = true; interrupted; ) {
    interrupted = false;
    await page.goto(address).catch((error) => {
      if (!String(error).includes('interrupted')) throw error;
      interrupted = true;
    });
  }
  await page.waitForFunction(() => window.meshhier?.settled());
}

/// Returns what the page holds, with the model open afresh.
async function held(page, session, address) {
  await page.keyboard.press('Escape');
  await page.evaluate(() => { window.meshhier.close(); });
  await opened(page, address);
  for (let round = 0; round < 3; ++round) await session.send('HeapProfiler.collectGarbage'); // a node may hold a script's object, and the other way
  const { metrics } = await session.send('Performance.getMetrics');
  const of = (name) => metrics.find((metric) => metric.name === name).value;
  return { heap: of('JSHeapUsedSize'), nodes: of('Nodes'), listeners: of('JSEventListeners') };
}

async function use(browser, report, { pictures, acts, origin, name, seed }) {
  const page = await browser.newPage({ viewport: VIEWPORT });
  const complaints = [];
  collectComplaints(page, complaints);
  page.on('crash', () => complaints.push('the page crashed'));
  const address = `${origin}/index.html#models/${name}.hier`;
  await opened(page, address);
  const session = await page.context().newCDPSession(page);
  await session.send('Performance.enable');
  const hand = new Hand(page, seed);
  const goOn = async (part) => {
    while (hand.done < part * acts) {
      await hand.burst();
      if (!page.url().includes(`#models/${name}`)) await opened(page, address); // it went to the gallery
    }
  };
  await goOn(EARLY);
  const early = await held(page, session, address);
  await goOn(1);
  await page.screenshot({ path: path.join(pictures, `random-use-${name}.png`) });
  report.line(`random use ${name}`, complaints.length === 0, `${hand.done} acts; ${[...new Set(complaints)].join('; ') || 'no complaints'}`);
  const late = await held(page, session, address);
  const grown = Object.keys(MORE).filter((what) => late[what] > early[what] * MORE[what].factor + MORE[what].some);
  report.line(`memory after random use ${name}`, grown.length === 0,
    Object.keys(MORE).map((what) => `${what} ${early[what]} early, ${late[what]} late`).join('; '));
  await page.close();
}

async function useAll(browser, report, [pictures, page, acts, ...directories]) {
  const hierarchies = directories.map(readHierarchy);
  await withSite(page, hierarchies, async (origin) => {
    for (const [seed, { name }] of hierarchies.entries()) await use(browser, report, { pictures, acts: Number(acts), origin, name, seed });
  });
}

const given = process.argv.slice(2);
if (given.length < 4 || !(Number(given[2]) > 0)) {
  console.log('usage: node random_use.mjs PICTURES PAGE ACTS HIERARCHY...');
  process.exit(2);
}
process.exit(await inChromium(given[0], (browser, report) => useAll(browser, report, given)));
