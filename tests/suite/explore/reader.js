// A reader of the page in a test: what the page shows and announces, and hands that press and choose.
"use strict";

// Pictures come by the browser's real clock, everything else in here by its virtual one.
window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), 16);
window.cancelAnimationFrame = clearTimeout;

const form = document.querySelector(".explore form"), log = [];
const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
window.addEventListener("error", (event) => log.push({ what: "error", status: event.message }));

// All that a screen reader has been given to say since the last note.
let heard = [];
new MutationObserver((changes) => {
  for (const { addedNodes } of changes) heard.push(...[...addedNodes].map((node) => node.textContent));
}).observe(document.querySelector('.explore [role="status"]'), { childList: true });

const marked = (field) => field.getAttribute("aria-invalid") || "";
// The text that describes f is where the page says what is wrong with it.
const status = () => document.getElementById(form.f.getAttribute("aria-describedby")).textContent;
const controls = () => Object.fromEntries(["problem", "f", "r", "load", "rule", "finest"]
  .map((name) => [name, form[name].value]).concat([["truth", String(form.truth.checked)]]));

// Waits until the page says nothing new: an iteration takes as long as the machine needs.
async function settle() {
  for (let said = null; said !== status();) {
    said = status();
    await sleep(500);
  }
}

async function note(what, milliseconds = 500) {
  await sleep(milliseconds);
  const row = document.querySelector(".explore-counts tbody tr");
  log.push({
    what,
    heard,
    status: status(),
    counts: row ? [...row.querySelectorAll("td")].map((cell) => cell.textContent).join(" ") : "",
    command: document.querySelector(".explore-command").textContent,
    marked: [marked(form.f), marked(form.r)],
    address: location.search,
    controls: controls(),
    unknown: document.querySelector(".explore-unknown:not([hidden])")?.textContent ?? "",
  });
  heard = [];
}

const press = (name) => document.querySelector(`.explore [data-do="${name}"]`).click();

function choose(name, value) {
  if (typeof value === "boolean") form[name].checked = value;
  else form[name].value = value;
  const control = form[name] instanceof RadioNodeList ? form.querySelector(`[name="${name}"]:checked`) : form[name];
  control.dispatchEvent(new Event("change", { bubbles: true }));
}

// Runs what a test does, and leaves the notes in the page.
function read(act) {
  act().catch((error) => log.push({ what: "error", status: String(error) })).finally(() => {
    document.body.dataset.log = JSON.stringify(log);
  });
}
