// What mdBook leaves out for readers with a keyboard or a screen reader.

// What is wider than its place can be scrolled by the keyboard, and fades at a side where more is hidden.
function scrollable() {
  for (const box of document.querySelectorAll(".table-wrapper, pre code, .equation, figure > a")) {
    const hidden = box.scrollWidth - box.clientWidth;
    if (hidden > 0) box.tabIndex = 0;
    else box.removeAttribute("tabindex");
    box.classList.toggle("more-before", hidden > 0 && box.scrollLeft > 1);
    box.classList.toggle("more-after", hidden > 0 && box.scrollLeft < hidden - 1);
  }
}
addEventListener("scroll", scrollable, { capture: true, passive: true });

// A head of a column that is a formula alone is read out as text.
for (const head of document.querySelectorAll("th")) {
  const formula = head.querySelector("math");
  const text = head.textContent.trim();
  if (formula && text === formula.textContent.trim()) {
    formula.setAttribute("aria-hidden", "true");
    const spoken = document.createElement("span");
    spoken.className = "spoken";
    spoken.textContent = text;
    head.append(spoken);
  }
}

// No line ends between the hyphens of an option.
for (const code of document.querySelectorAll("main :not(pre) > code")) {
  const parts = code.textContent.split(/(?<![^\s])(-\S{1,20})(?!\S)/);
  if (parts.length === 1) continue;
  code.replaceChildren(...parts.map((part, k) => {
    const word = document.createElement("span");
    word.className = k % 2 ? "option" : "";
    word.textContent = part;
    return word;
  }));
}

// The table of contents comes before the text: a link past it, for readers with a keyboard.
const text = document.querySelector("main");
if (text) {
  text.id ||= "text";
  text.tabIndex = -1;
  const skip = document.createElement("a");
  skip.className = "skip";
  skip.href = `#${text.id}`;
  skip.textContent = "To the text";
  document.body.prepend(skip);
}

document.getElementById("mdbook-menu-bar")?.setAttribute("role", "banner");

// mdBook's switch of the table of contents is a label, which no keyboard reaches and of which nothing may be said to be
// expanded. A button in its place does what the label does.
const label = document.getElementById("mdbook-sidebar-toggle");
if (label) {
  const button = document.createElement("button");
  button.className = label.className;
  button.append(...label.childNodes);
  const follow = () => {
    for (const name of ["title", "aria-label", "aria-controls", "aria-expanded"]) {
      if (label.hasAttribute(name)) button.setAttribute(name, label.getAttribute(name));
    }
  };
  follow();
  new MutationObserver(follow).observe(label, { attributes: true });
  button.addEventListener("click", () => label.click());
  label.hidden = true;
  label.after(button);
}

addEventListener("load", scrollable);
addEventListener("resize", scrollable);
scrollable();
