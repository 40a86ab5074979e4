// Search in all sections of all pages. The index is loaded when the field is first used; it is a script, because a page that was
// opened as a file may not fetch.
const script = document.currentScript;
const field = document.getElementById("site-search");
const list = document.getElementById("site-results");
let searchIndex;

/** Words of a text that can be compared: small letters, without accents. */
const plain = (text) => text.toLowerCase().normalize("NFKD").replace(/[\u0300-\u036f]/g, "");

function load() {
  if (document.getElementById("site-index")) return;
  const index = document.createElement("script");
  index.id = "site-index";
  index.src = `${script.dataset.root}/search/search_index.js`;
  index.onload = search;
  document.head.append(index);
}

/** How well a section answers: 0 where a word is missing, more where words are in its title or begin words. */
function score(section, words) {
  let sum = 0;
  for (const word of words) {
    if (section.plainTitle.includes(word)) sum += 20;
    const place = section.plainText.indexOf(word);
    if (place < 0 && !section.plainTitle.includes(word)) return 0;
    if (place >= 0) sum += /\w/.test(section.plainText[place - 1] ?? " ") ? 1 : 3;
  }
  return sum / Math.log(60 + section.text.length);
}

function search() {
  const words = plain(field.value).split(/\s+/).filter(Boolean);
  list.hidden = words.length === 0;
  list.replaceChildren();
  if (!searchIndex || words.length === 0) return;
  for (const section of searchIndex.docs) {
    section.plainTitle ??= plain(section.title);
    section.plainText ??= plain(section.text);
  }
  const found = searchIndex.docs.map((section) => [score(section, words), section]).filter(([points]) => points > 0);
  found.sort(([a], [b]) => b - a);
  for (const [, section] of found.slice(0, 12)) list.append(entry(section, words));
  if (found.length === 0) list.append(Object.assign(document.createElement("li"), { textContent: "Nothing found" }));
}

function entry(section, words) {
  const start = Math.max(0, section.plainText.indexOf(words[0]) - 40);
  const link = document.createElement("a");
  link.href = `${script.dataset.root}/${section.location}`;
  const title = Object.assign(document.createElement("b"), { textContent: unescaped(section.title) });
  const text = Object.assign(document.createElement("span"), { textContent: unescaped(section.text.slice(start, start + 140)) });
  link.append(title, text);
  link.onclick = () => (list.hidden = true);
  const item = document.createElement("li");
  item.append(link);
  return item;
}

/** The index has character references. */
const unescaped = (html) => new DOMParser().parseFromString(html, "text/html").documentElement.textContent;

field.addEventListener("focus", load);
field.addEventListener("input", search);
document.addEventListener("keydown", (event) => {
  if (event.key === "Escape") list.hidden = true;
  if (event.key === "Enter" && event.target === field) list.querySelector("a")?.click();
  if (event.key === "/" && !/^(INPUT|TEXTAREA)$/.test(event.target.tagName)) {
    event.preventDefault();
    field.focus();
  }
});
