"use strict";
// The sweep's rows are kept column by column; a view is the list of rows that pass the filters, in order. Only leaves near the window are in the document.
// All texts of the sweep go in as text, never as markup.

const $ = id => document.getElementById(id);
const OUTCOME = ["grown", "failed", "missing"];
const sweep = { keys: [] };
const columns = new Map(); // name -> { name, label, unit, doc, type, key, value: [], numeric, low, high, distinct }
let loaded = 0, ready = false;
let view = [];      // rows
let current = 0;    // place in the view that has the keyboard
const state = { q: "", sort: "", down: false, size: 180, filter: new Map(), open: -1 };

function make(tag, attributes, ...children) {
  const e = document.createElement(tag);
  for (const [k, v] of Object.entries(attributes || {}))
    if (k.startsWith("on")) e.addEventListener(k.slice(2), v);
    else if (v === true) e.setAttribute(k, "");
    else if (v !== false && v != null) e.setAttribute(k, v);
  e.append(...children.filter(c => c != null));
  return e;
}

function venationTrouble(file) {
  $("trouble").hidden = false;
  $("trouble").textContent = file + " can't be read: the page needs the folder page beside it.";
}

// ---- loading ----

function venationSweep(s) {
  Object.assign(sweep, s);
  for (const k of s.keys) columnOf(k.key);
  let next = 0;
  const more = () => {
    if (next >= s.chunks) return;
    const file = "page/" + next++ + ".js";
    const script = make("script", { src: file });
    script.onload = () => { script.remove(); more(); progress(); };
    script.onerror = () => { venationTrouble(file); more(); };
    document.head.append(script);
  };
  for (let i = 0; i < 4; i++) more();
}

function columnOf(name) {
  let c = columns.get(name);
  if (!c) {
    const key = sweep.keys.find(k => k.key === name);
    c = { name, key, label: key ? key.label : name.replace(/_/g, " "), unit: key ? key.unit : "", type: key ? key.type : "", doc: key ? key.doc : "", value: [] };
    columns.set(name, c);
  }
  return c;
}

function venationRows(first, n, data) {
  for (const [name, d] of Object.entries(data)) {
    const to = columnOf(name).value;
    for (let i = 0; i < n; i++)
      to[first + i] = Array.isArray(d) ? d[i] : "c" in d ? d.c : d.d[d.i[i]];
  }
  loaded += n;
}

function progress() {
  if (ready) return;
  $("count").textContent = "Loading, " + count(loaded) + " of " + count(sweep.count);
  if (loaded === sweep.count) begin();
}

function finish(c) {
  let numeric = true, any = false, low = Infinity, high = -Infinity;
  const distinct = new Map();
  for (let i = 0; i < sweep.count; i++) {
    const v = c.value[i] === undefined ? (c.value[i] = null) : c.value[i];
    if (distinct.size <= 400) distinct.set(v, (distinct.get(v) || 0) + 1);
    if (v === null) continue;
    any = true;
    if (typeof v !== "number") numeric = false;
    else { if (v < low) low = v; if (v > high) high = v; }
  }
  c.numeric = numeric && any;
  c.low = low; c.high = high;
  c.distinct = distinct.size <= 400 ? distinct : null;
  c.log = c.numeric && low > 0 && high / low >= 50;
}

// ---- values as text ----

const count = n => String(n).replace(/\B(?=(\d{3})+$)/g, "\u202f");

function plain(v) {
  if (v === null || v === undefined) return "";
  if (typeof v !== "number") return String(v);
  if (Number.isInteger(v)) return String(v).replace("-", "−");
  return String(+v.toPrecision(5)).replace("-", "−").replace(/e−?-?(\d+)/, (m, d) => " × 10" + (m.includes("-") || m.includes("−") ? "⁻" : "") + [...d].map(x => "⁰¹²³⁴⁵⁶⁷⁸⁹"[x]).join(""));
}

// As cards and filters show it: the base name of a file; the parameter file's value where the sweep gives none.
function shown(c, v) {
  if (v === null || v === undefined) return c.key ? (c.key.own || "none") + " (as in the file)" : "–";
  if (v === "") return "none";
  if (c.type === "file") return String(v).split("/").pop().replace(/(.)\.[^.]*$/, "$1");
  return plain(v);
}

const colourOf = (c, v) => c.type === "colour" && /^#[0-9a-f]{6}$/i.test(v || "") ? v : null;

function swatch(c, v) {
  const colour = colourOf(c, v);
  if (!colour) return null;
  const e = make("span", { class: "swatch" });
  e.style.background = colour;
  return e;
}

const at = (name, row) => { const c = columns.get(name); return c ? c.value[row] : null; };
const nameOf = row => at("@name", row) || String(row);
const path = p => p.split("/").map(encodeURIComponent).join("/");

function folderOf(row) {
  const f = at("@folder", row);
  return f == null ? null : path(at("@own", row) ? f + "/" + nameOf(row) : f);
}

function pictureOf(row) {
  const picture = at("@picture", row), folder = folderOf(row);
  return picture && folder ? folder + "/" + path(picture) : null;
}

const filesOf = row => (at("@files", row) || "").split("/").filter(f => f).map(f => f.startsWith("*") ? nameOf(row) + f.slice(1) : f);

// Seeds that differ everywhere tell nothing.
const varying = () => [...columns.values()].filter(c => c.key && c.key.varies && (c.name !== "seed" || c.key.levels > 0));
const results = () => [...columns.values()].filter(c => !c.key && !c.name.startsWith("@") && c.name !== "seed");

// ---- filters ----

function passes(row, except) {
  for (const [name, f] of state.filter) {
    if (name === except) continue;
    const c = columns.get(name);
    if (!c) continue;
    const v = c.value[row];
    if (f.any) { if (!f.any.has(v)) return false; }
    else if (v === null || v < f.low || v > f.high) return false;
  }
  return true;
}

function searcher() {
  const q = state.q.trim().toLowerCase();
  if (!q) return null;
  const texts = [...columns.values()].filter(c => c.name === "@name" || c.name === "@error" || (c.key && c.key.varies && !c.numeric)), names = columns.get("@name");
  const known = new Map();
  return row => {
    if (String(row) === q.replace(/^#/, "")) return true;
    for (const c of texts) {
      const v = c.value[row];
      if (v === null) continue;
      if (c === names) { if (v.toLowerCase().includes(q)) return true; continue; }
      let hit = known.get(v);
      if (hit === undefined) known.set(v, hit = String(v).toLowerCase().includes(q));
      if (hit) return true;
    }
    return false;
  };
}

function choose() {
  const find = searcher(), rows = [];
  for (let i = 0; i < sweep.count; i++)
    if (passes(i) && (!find || find(i))) rows.push(i);
  const c = columns.get(state.sort);
  const sign = state.down ? -1 : 1;
  if (c) {
    const v = c.value;
    rows.sort((a, b) => {
      const x = v[a], y = v[b];
      if (x === y) return a - b;
      if (x === null) return 1;
      if (y === null) return -1;
      return (x < y ? -1 : x > y ? 1 : 0) * sign || a - b;
    });
  } else if (state.down) rows.reverse();
  return rows;
}

const widgets = [];

function setFilter(name, f) {
  if (f) state.filter.set(name, f); else state.filter.delete(name);
  later();
}

function frame(c, ...children) {
  const box = make("fieldset", {}, make("legend", { title: c.doc || null }, c.label, c.unit ? make("span", { class: "unit" }, " (" + c.unit + ")") : null,
    make("button", { type: "button", class: "clear", "aria-label": "Clear the filter of " + c.label, onclick: () => { setFilter(c.name, null); } }, "clear")), ...children);
  return box;
}

function choiceFilter(c, label) {
  const values = [...c.distinct.entries()].sort((a, b) => a[0] === null ? 1 : b[0] === null ? -1 : a[0] < b[0] ? -1 : 1);
  const list = make("div", { class: "choices" });
  const boxes = values.map(([v]) => {
    const input = make("input", { type: "checkbox" }), n = make("span", { class: "n" }), text = label ? label(v) : shown(c, v);
    input.addEventListener("change", () => {
      const any = new Set(boxes.filter(b => b.input.checked).map(b => b.v));
      setFilter(c.name, any.size ? { any } : null);
    });
    list.append(make("label", { class: "choice", title: text }, input, swatch(c, v) || make("span"), make("span", { class: "text" }, text), n));
    return { v, input, n };
  });
  const box = frame(c, list);
  return {
    box,
    update() {
      const f = state.filter.get(c.name), n = new Map();
      for (let i = 0; i < sweep.count; i++) if (passes(i, c.name)) n.set(c.value[i], (n.get(c.value[i]) || 0) + 1);
      box.classList.toggle("active", !!f);
      for (const b of boxes) {
        b.input.checked = !!(f && f.any && f.any.has(b.v));
        b.n.textContent = count(n.get(b.v) || 0);
      }
    },
  };
}

function rangeFilter(c) {
  const STEPS = 1000, BINS = 30, log = c.log;
  const to = v => log ? Math.log(v / c.low) / Math.log(c.high / c.low) : (v - c.low) / (c.high - c.low);
  const from = u => u <= 0 ? c.low : u >= 1 ? c.high : +(log ? c.low * Math.pow(c.high / c.low, u) : c.low + u * (c.high - c.low)).toPrecision(4);
  const slider = name => make("input", { type: "range", min: 0, max: STEPS, step: 1, "aria-label": c.label + ", " + name });
  const number = name => make("input", { type: "number", step: "any", "aria-label": c.label + ", " + name });
  const a = slider("least"), b = slider("most"), low = number("least"), high = number("most");
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("class", "histogram");
  svg.setAttribute("viewBox", "0 0 " + BINS * 8 + " 44");
  svg.setAttribute("preserveAspectRatio", "none");
  svg.setAttribute("aria-hidden", "true");
  const bar = (k, kind) => {
    const r = document.createElementNS("http://www.w3.org/2000/svg", "rect");
    r.setAttribute("x", k * 8); r.setAttribute("width", 7); r.setAttribute("class", kind);
    svg.append(r);
    return r;
  };
  const all = Array.from({ length: BINS }, (_, k) => bar(k, "all")), some = Array.from({ length: BINS }, (_, k) => bar(k, "some"));
  const total = new Array(BINS).fill(0), bins = new Uint8Array(sweep.count).fill(255);
  for (let i = 0; i < sweep.count; i++) {
    const v = c.value[i];
    if (v !== null) total[bins[i] = Math.min(BINS - 1, Math.floor(to(v) * BINS))]++;
  }
  const most = Math.max(...total, 1), height = n => n ? Math.max(1.5, 42 * n / most) : 0;
  const put = (r, n) => { r.setAttribute("y", 44 - height(n)); r.setAttribute("height", height(n)); };
  all.forEach((r, k) => put(r, total[k]));
  const apply = (x, y) => setFilter(c.name, x <= c.low && y >= c.high ? null : { low: Math.min(x, y), high: Math.max(x, y) });
  const slide = () => apply(from(Math.min(a.value, b.value) / STEPS), from(Math.max(a.value, b.value) / STEPS));
  a.addEventListener("input", slide);
  b.addEventListener("input", slide);
  const type = () => apply(low.value === "" ? c.low : +low.value, high.value === "" ? c.high : +high.value);
  low.addEventListener("change", type);
  high.addEventListener("change", type);
  const box = frame(c, svg, make("div", { class: "range" }, a, b), make("div", { class: "ends" }, low, high));
  return {
    box,
    update() {
      const f = state.filter.get(c.name), x = f ? f.low : c.low, y = f ? f.high : c.high, n = new Array(BINS).fill(0);
      for (let i = 0; i < sweep.count; i++) if (bins[i] !== 255 && passes(i)) n[bins[i]]++;
      some.forEach((r, k) => put(r, n[k]));
      box.classList.toggle("active", !!f);
      const place = v => Math.round(STEPS * Math.min(1, Math.max(0, log && v <= 0 ? 0 : to(v))));
      if (document.activeElement !== a && document.activeElement !== b) { a.value = place(x); b.value = place(y); }
      if (document.activeElement !== low) low.value = f ? +x.toPrecision(6) : "";
      if (document.activeElement !== high) high.value = f ? +y.toPrecision(6) : "";
      low.placeholder = String(+c.low.toPrecision(4)); high.placeholder = String(+c.high.toPrecision(4));
    },
  };
}

function filterOf(c) {
  const few = c.distinct && c.distinct.size <= 12;
  if (c.distinct && c.distinct.size < 2) return null;
  if (c.numeric && !(few && c.key && c.key.levels > 0)) return rangeFilter(c);
  return c.distinct && c.distinct.size <= 200 ? choiceFilter(c) : null;
}

function buildFilters() {
  const aside = $("filters"), outcome = columns.get("@outcome");
  outcome.label = "outcome";
  if (outcome.distinct.size > 1) widgets.push(choiceFilter(outcome, v => OUTCOME[v]));
  const lists = c => c.type === "points"; // long, and hardly a help: last
  for (const c of [...varying().filter(c => !lists(c)), ...varying().filter(lists)]) widgets.push(filterOf(c));
  const more = results().filter(c => c.numeric || (c.distinct && c.distinct.size <= 12)).map(filterOf).filter(w => w);
  for (const w of widgets) if (w) aside.append(w.box);
  if (more.length) {
    const open = [...state.filter.keys()].some(n => !columns.get(n)?.key && n !== "@outcome");
    const details = make("details", { open }, make("summary", {}, "What came of it"), ...more.map(w => w.box));
    details.addEventListener("toggle", () => { if (details.open) more.forEach(w => w.update()); });
    aside.append(details);
    widgets.push({ update: () => { if (details.open) more.forEach(w => w.update()); } });
  }
  for (let i = widgets.length; i-- > 0;) if (!widgets[i]) widgets.splice(i, 1);
}

function buildSort() {
  const select = $("sort");
  const group = (label, list) => list.length ? select.append(make("optgroup", { label }, ...list.map(c => make("option", { value: c.name }, c.label)))) : null;
  select.append(make("option", { value: "" }, "number"));
  group("Parameters", varying());
  group("What came of it", results().filter(c => c.numeric || (c.distinct && c.distinct.size > 1)));
  if (columns.get("@outcome").distinct.size > 1) select.append(make("option", { value: "@outcome" }, "outcome"));
  if (!columns.has(state.sort)) state.sort = "";
  select.value = state.sort;
}

// ---- the address keeps what is shown ----

function save() {
  const p = new URLSearchParams();
  if (state.q) p.set("q", state.q);
  if (state.sort || state.down) p.set("sort", (state.down ? "-" : "") + state.sort);
  if (state.size !== 180) p.set("size", state.size);
  for (const [name, f] of state.filter) {
    if (f.any) for (const v of f.any) p.append("f." + name, v === null ? "~" : "=" + v);
    else p.append("f." + name, f.low + ".." + f.high);
  }
  if (state.open >= 0) p.set("v", state.open);
  const hash = "#" + p;
  if (hash === location.hash || (hash === "#" && !location.hash)) return;
  try { history.replaceState(null, "", hash); } catch { /* some browsers don't allow it of files */ }
}

function restore() {
  const p = new URLSearchParams(location.hash.slice(1));
  state.q = p.get("q") || "";
  const sort = p.get("sort") || "";
  state.down = sort.startsWith("-");
  state.sort = sort.replace(/^-/, "");
  state.size = Math.min(340, Math.max(90, +p.get("size") || 180));
  state.filter.clear();
  for (const [k, v] of p) {
    const c = k.startsWith("f.") ? columns.get(k.slice(2)) : null, range = /^(.+?)\.\.(.+)$/.exec(v);
    if (!c) continue;
    if (v === "~" || v.startsWith("=")) {
      const f = state.filter.get(c.name) || { any: new Set() };
      if (f.any) f.any.add(v === "~" ? null : c.numeric ? +v.slice(1) : v.slice(1));
      state.filter.set(c.name, f);
    } else if (range && isFinite(range[1]) && isFinite(range[2])) {
      state.filter.set(c.name, { low: +range[1], high: +range[2] });
    }
  }
  const open = p.get("v");
  state.open = open !== null && /^\d+$/.test(open) && +open < sweep.count ? +open : -1;
}

// ---- leaves near the window ----

const TALLEST = 6e6; // pixels: browsers lay out no more than some ten million, so longer views scroll faster than they are
const grid = { columns: 1, width: 0, height: 0, shown: new Map(), lines: 0, tall: 0 };

function captionColumns() {
  const list = sweep.told.map(columnOf).filter(c => !c.distinct || c.distinct.size > 1), sorted = columns.get(state.sort);
  return sorted && sorted.name !== "@outcome" ? [sorted, ...list.filter(c => c !== sorted)].slice(0, 3) : list;
}

function measure() {
  const width = $("leaves").clientWidth;
  grid.columns = Math.max(1, Math.floor(width / (state.size + 12)));
  grid.width = Math.floor(width / grid.columns);
  grid.caption = captionColumns();
  grid.named = sweep.mode !== "sample" && !varying().some(c => nameOf(0).includes(c.name.split(".").pop() + "-")); // the user's names, not made of values
  grid.height = grid.width + 8 + 22 + 20 * grid.caption.length;
  grid.lines = Math.ceil(view.length / grid.columns);
  grid.tall = Math.min(grid.lines * grid.height, TALLEST);
  $("leaves").style.height = grid.tall + "px";
  const head = document.querySelector("header");
  document.documentElement.style.setProperty("--head", (getComputedStyle(head).position === "sticky" ? head.offsetHeight : 0) + "px");
}

// How far the window is into the leaves as they would stand without a limit, and where that is in the document.
function scrolled() {
  const top = $("leaves").getBoundingClientRect().top, inside = Math.max(0, -top), room = grid.tall - innerHeight, real = grid.lines * grid.height;
  if (real <= TALLEST || room <= 0) return { from: inside, shift: 0 };
  const from = Math.min(1, inside / room) * (real - innerHeight);
  return { from, shift: inside - from };
}

function card(place) {
  const row = view[place], outcome = at("@outcome", row), picture = pictureOf(row), name = nameOf(row);
  let paper;
  if (picture) {
    const image = make("img", { alt: "", draggable: "false", src: picture });
    image.addEventListener("error", () => { image.replaceWith(make("span", {}, "no picture")); });
    paper = make("div", { class: "picture" }, image);
  } else {
    paper = make("div", { class: "picture plain " + OUTCOME[outcome] },
      make("div", {}, make("b", {}, outcome === 0 ? "grown, no picture" : OUTCOME[outcome]), at("@error", row) ? make("span", {}, at("@error", row)) : null));
  }
  paper.style.height = grid.width - 12 + "px";
  const e = make("div", { class: "leaf", role: "option", id: "leaf-" + row, "aria-posinset": place + 1, "aria-setsize": view.length, "aria-selected": "false",
    tabindex: place === current ? 0 : -1, title: name, "aria-label": name + ", " + OUTCOME[outcome] }, paper,
    make("p", { class: "first" }, grid.named ? name : "#" + row),
    ...grid.caption.map(c => make("p", {}, make("span", { class: "label" }, c.label + " "), swatch(c, c.value[row]), colourOf(c, c.value[row]) ? " " : "", shown(c, c.value[row]))));
  e.style.width = grid.width + "px";
  e.style.height = grid.height + "px";
  e.place = place;
  return e;
}

function draw(anew) {
  const leaves = $("leaves"), { from, shift } = scrolled(), over = grid.height;
  const first = Math.max(0, Math.floor((from - over) / grid.height)) * grid.columns;
  const last = Math.min(view.length, (Math.floor((from + innerHeight + over) / grid.height) + 1) * grid.columns);
  for (const [place, e] of grid.shown)
    if (anew || ((place < first || place >= last) && e !== document.activeElement)) { e.remove(); grid.shown.delete(place); }
  const add = document.createDocumentFragment();
  for (let place = first; place < last; place++)
    if (!grid.shown.has(place)) { const e = card(place); grid.shown.set(place, e); add.append(e); }
  leaves.append(add);
  for (const [place, e] of grid.shown)
    e.style.transform = "translate(" + place % grid.columns * grid.width + "px," + (Math.floor(place / grid.columns) * grid.height + shift) + "px)";
}

function goTo(place, focus) {
  if (!view.length) return;
  const old = grid.shown.get(current);
  if (old) old.tabIndex = -1;
  current = Math.min(view.length - 1, Math.max(0, place));
  const real = grid.lines * grid.height, y = Math.floor(current / grid.columns) * grid.height;
  const head = parseFloat(getComputedStyle(document.documentElement).getPropertyValue("--head")) || 0, { from } = scrolled();
  let want = null;
  if (y < from + head) want = y - head - 8;
  else if (y + grid.height > from + innerHeight) want = y + grid.height - innerHeight + 8;
  if (want !== null) {
    const start = $("leaves").getBoundingClientRect().top + scrollY, room = grid.tall - innerHeight;
    scrollTo({ top: start + (real <= TALLEST ? want : want / (real - innerHeight) * room) });
  }
  draw();
  const e = grid.shown.get(current);
  if (e) { e.tabIndex = 0; if (focus) e.focus({ preventScroll: true }); }
}

function refresh() {
  view = choose();
  current = 0;
  grid.shown.forEach(e => e.remove());
  grid.shown.clear();
  $("count").textContent = view.length === sweep.count ? count(sweep.count) + (sweep.count === 1 ? " variant" : " variants") : count(view.length) + " of " + count(sweep.count);
  $("nothing").hidden = view.length > 0;
  $("descending").setAttribute("aria-pressed", state.down);
  measure();
  draw(true);
  for (const w of widgets) w.update();
  save();
}

let waiting = 0;
function later() { cancelAnimationFrame(waiting); waiting = requestAnimationFrame(refresh); }

// ---- one variant ----

const quote = s => /^[\w@%+=:,./-]+$/.test(s) ? s : "'" + s.replace(/'/g, "'\\''") + "'";

// What grows this variant alone, in the sweep file's folder, where files start.
function command(row) {
  const words = ["venation grow " + quote(sweep.params)];
  const seed = at("seed", row);
  if (seed !== null && seed !== undefined) words.push("--seed " + quote(String(seed)));
  for (const assignment of sweep.set) words.push("--set " + quote(assignment));
  for (const k of sweep.keys) {
    const v = at(k.key, row);
    if (k.key === "seed" || v === null) continue;
    words.push("--set " + quote(k.key + "=" + v));
  }
  words.push("-o " + quote("out/" + nameOf(row)));
  return words.join(" \\\n  ");
}

function table(list, row) {
  return make("table", {}, make("tbody", {}, ...list.map(c => make("tr", {}, make("th", { scope: "row", title: c.doc ? c.name + ": " + c.doc : c.name }, c.label),
    make("td", {}, swatch(c, c.value[row]), colourOf(c, c.value[row]) ? " " : "",
      c.value[row] === null || c.value[row] === "" || !c.key ? shown(c, c.value[row]) : String(c.value[row]).replace(/^-(?=\d)/, "−"), c.unit && c.value[row] !== null ? make("span", { class: "key" }, " " + c.unit) : null)))));
}

function largePictures(row) {
  const folder = folderOf(row), name = nameOf(row), own = at("@picture", row);
  const files = filesOf(row).filter(f => /\.(png|jpe?g|svg|webp)$/i.test(f));
  const rank = f => f === name + "_specimen.png" ? 0 : f === name + "_veins.png" ? 1 : f === name + "_base_color.png" ? 2 : f === name + ".svg" ? 3 : f === own ? 9 : 5;
  files.sort((a, b) => rank(a) - rank(b));
  return files.map(f => ({ url: folder + "/" + path(f), label: f === own ? "small" : f === name + ".svg" ? "drawing" : (f.startsWith(name + "_") ? f.slice(name.length + 1) : f).replace(/\.\w+$/, "").replace(/_/g, " ") }));
}

function showLarge(row) {
  const pictures = largePictures(row), image = make("img", { alt: nameOf(row) }), tabs = make("div", { class: "tabs" });
  const pick = i => {
    image.src = pictures[i].url;
    [...tabs.children].forEach((b, k) => b.setAttribute("aria-pressed", k === i));
  };
  pictures.forEach((p, i) => tabs.append(make("button", { type: "button", onclick: () => pick(i) }, p.label)));
  if (pictures.length) pick(0);
  return make("div", { class: "large" }, make("div", { class: "paper" }, pictures.length ? image : OUTCOME[at("@outcome", row)]), pictures.length > 1 ? tabs : null);
}

function open(row) {
  state.open = row;
  const dialog = $("one"), outcome = at("@outcome", row), folder = folderOf(row), files = filesOf(row), place = view.indexOf(row), line = command(row);
  const keys = [...columns.values()].filter(c => c.key), seed = columns.get("seed");
  const fixed = keys.filter(c => !c.key.varies), came = results().filter(c => c.value[row] !== null);
  const told = make("div", { class: "told" },
    at("@error", row) ? make("p", { class: "error" }, at("@error", row)) : null,
    make("h3", {}, "What varies"), table(keys.filter(c => c.key.varies), row),
    fixed.length || (seed && !seed.key) ? make("h3", {}, "What stays") : null,
    fixed.length || (seed && !seed.key) ? table(seed && !seed.key ? [...fixed, seed] : fixed, row) : null,
    came.length ? make("h3", {}, "What came of it") : null, came.length ? table(came, row) : null,
    make("h3", {}, "To grow it alone, in the folder of " + sweep.file), make("pre", {}, line),
    make("button", { type: "button", onclick: e => { navigator.clipboard?.writeText(line).then(() => { e.target.textContent = "Copied"; }, () => {}); } }, "Copy"),
    files.length ? make("h3", {}, "Files") : null,
    files.length ? make("ul", {}, ...files.map(f => make("li", {}, make("a", { href: folder + "/" + path(f), target: "_blank", rel: "noopener" }, f)))) : null);
  const step = d => { const p = place + d; if (p >= 0 && p < view.length) { current = p; open(view[p]); } };
  const bar = make("div", { class: "bar" }, make("h2", { id: "one-name" }, nameOf(row) + (outcome ? ", " + OUTCOME[outcome] : "")),
    make("button", { type: "button", "aria-label": "Previous", disabled: place <= 0, onclick: () => step(-1) }, "←"),
    make("button", { type: "button", "aria-label": "Next", disabled: place < 0 || place + 1 >= view.length, onclick: () => step(1) }, "→"),
    make("button", { type: "button", "aria-label": "Close", onclick: () => dialog.close() }, "✕"));
  dialog.replaceChildren(make("div", { class: "one" }, bar, showLarge(row), told));
  dialog.onkeydown = e => {
    if (e.altKey || e.ctrlKey || e.metaKey || e.shiftKey) return;
    if (e.key === "ArrowLeft") { step(-1); e.preventDefault(); }
    if (e.key === "ArrowRight") { step(1); e.preventDefault(); }
  };
  if (!dialog.open) dialog.showModal();
  save();
}

// ---- beginning ----

function settle() {
  restore();
  $("search").value = state.q;
  $("size").value = state.size;
  if (columns.has(state.sort)) $("sort").value = state.sort; else $("sort").value = state.sort = "";
}

function listen() {
  const leaves = $("leaves"), dialog = $("one");
  $("search").addEventListener("input", e => { state.q = e.target.value; later(); });
  $("sort").addEventListener("change", e => { state.sort = e.target.value; later(); });
  $("descending").addEventListener("click", () => { state.down = !state.down; later(); });
  $("size").addEventListener("input", e => { state.size = +e.target.value; measure(); draw(true); save(); });
  $("reset").addEventListener("click", () => { state.filter.clear(); state.q = $("search").value = ""; later(); });
  $("show-filters").addEventListener("click", e => { e.target.setAttribute("aria-expanded", $("filters").classList.toggle("open")); });
  leaves.addEventListener("click", e => { const leaf = e.target.closest(".leaf"); if (leaf) { goTo(leaf.place, true); open(view[leaf.place]); } });
  leaves.addEventListener("keydown", e => {
    const step = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: -grid.columns, ArrowDown: grid.columns, PageUp: -3 * grid.columns, PageDown: 3 * grid.columns, Home: -Infinity, End: Infinity }[e.key];
    if (step !== undefined) { goTo(current + step, true); e.preventDefault(); }
    if (e.key === "Enter" || e.key === " ") { open(view[current]); e.preventDefault(); }
  });
  document.addEventListener("keydown", e => {
    if (e.key === "/" && !dialog.open && !/^(INPUT|SELECT|TEXTAREA)$/.test(document.activeElement.tagName)) { $("search").focus(); e.preventDefault(); }
  });
  dialog.addEventListener("click", e => { if (e.target === dialog) dialog.close(); });
  dialog.addEventListener("close", () => { state.open = -1; save(); goTo(current, true); });
  let drawing = 0;
  addEventListener("scroll", () => { cancelAnimationFrame(drawing); drawing = requestAnimationFrame(() => draw()); }, { passive: true });
  addEventListener("resize", () => { measure(); draw(true); });
  addEventListener("hashchange", () => { settle(); refresh(); if (state.open >= 0) open(state.open); else if (dialog.open) dialog.close(); });
}

function begin() {
  ready = true;
  columns.forEach(finish);
  restore();
  buildSort();
  settle();
  buildFilters();
  listen();
  const one = state.open;
  refresh();
  if (one >= 0) { current = Math.max(0, view.indexOf(one)); open(one); }
}
