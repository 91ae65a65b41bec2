// Finds the sections of search-data.js with all words of the field. Headings count more than text.
const field = document.querySelector("input[type=search]"), list = document.querySelector("#found");

const loaded = new Promise((done) => {
  const load = () => {
    const script = document.createElement("script");
    script.src = "search-data.js";
    script.onload = () => done(sections);
    document.head.append(script);
  };
  field.addEventListener("focus", load, { once: true });
});

function score([title, heading, , text], words) {
  let sum = 0;
  for (const word of words) {
    const inHeading = heading.toLowerCase().indexOf(word), inTitle = title.toLowerCase().includes(word), inText = text.toLowerCase().indexOf(word);
    if (inHeading < 0 && !inTitle && inText < 0) return 0;
    sum += (inHeading >= 0 ? 20 - Math.min(10, heading.length - word.length) : 0) + (inTitle ? 3 : 0) + (inText >= 0 ? 1 : 0);
  }
  return sum + (text.toLowerCase().includes(words.join(" ")) ? 2 : 0);
}

function item([title, heading, url, text], words) {
  const link = document.createElement("a"), where = document.createElement("small"), said = document.createElement("p");
  link.href = url;
  link.textContent = heading;
  where.textContent = title === heading ? "" : ` ${title}`;
  const at = Math.max(0, Math.min(...words.map((word) => text.toLowerCase().indexOf(word)).filter((place) => place >= 0), text.length));
  said.textContent = at < text.length ? `${at > 60 ? "… " : ""}${text.slice(Math.max(0, at - 60), at + 120)} …` : `${text.slice(0, 180)}`;
  const entry = document.createElement("li");
  entry.append(link, where, said);
  return entry;
}

field.addEventListener("input", async () => {
  const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
  const ranked = (await loaded).map((section) => [score(section, words), section]).filter(([points]) => words.length && points > 0);
  ranked.sort(([one], [other]) => other - one);
  list.replaceChildren(...ranked.slice(0, 20).map(([, section]) => item(section, words)));
  if (words.length && !ranked.length) list.append(`No section contains all of: ${words.join(", ")}`);
  list.hidden = !words.length;
});
field.addEventListener("keydown", (event) => {
  if (event.key === "Enter") list.querySelector("a")?.click();
  if (event.key === "Escape") list.hidden = true;
});
document.addEventListener("keydown", (event) => {
  if (event.key !== "/" || event.target === field) return;
  event.preventDefault();
  field.focus();
});
document.addEventListener("click", (event) => (list.hidden = list.hidden || !event.target.closest("header")));

const button = document.querySelector("header button");
button.addEventListener("click", () => button.setAttribute("aria-expanded", document.querySelector("nav").classList.toggle("open")));
