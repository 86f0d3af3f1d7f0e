// A lecture: one step of its text at a time, and the picture that belongs to it.

const unpackColours = async ({ colours, patches }) => {
  const bytes = await unpack(colours, 3, patches), plate = padded(patches);
  for (let i = 0; i < patches; i++) for (let c = 0; c < 3; c++) plate[3 * i + c] = bytes[c * patches + i] / 255;
  return plate;
};

class Talk {
  constructor(meta) {
    Object.assign(this, { meta, number: 0, revealed: false, camera: null });
    this.section = $("talk");
    this.articles = [...this.section.querySelectorAll("article")];
    this.section.classList.add("live");
    for (const button of this.section.querySelectorAll(".reveal")) button.onclick = () => this.forward();
    $("talk-on").onclick = () => this.forward();
    $("talk-back").onclick = () => this.back();
    this.dots = meta.steps.map((step, i) => {
      const dot = $("dots").appendChild(Object.assign(document.createElement("button"), { type: "button", title: this.articles[i].querySelector("h2").textContent }));
      dot.setAttribute("aria-label", `step ${i + 1}: ${dot.title}`);
      dot.onclick = () => this.go(i, false);
      return dot;
    });
    this.go(clamp((Number(new URLSearchParams(location.hash.slice(1)).get("step")) || 1) - 1, 0, meta.steps.length - 1), false);
  }

  get step() { return this.meta.steps[this.number]; }
  get asking() { return Boolean(this.step.reveal) && !this.revealed; }

  // The answer if a question waits, else the next step.
  forward() {
    if (this.asking) this.go(this.number, true);
    else if (this.number + 1 < this.meta.steps.length) this.go(this.number + 1, false);
  }

  // To the question before the answer, or to the step before, with its answer.
  back() {
    if (this.revealed) this.go(this.number, false);
    else if (this.number) this.go(this.number - 1, Boolean(this.meta.steps[this.number - 1].reveal));
  }

  go(number, revealed) {
    const moved = number !== this.number || !this.shown;
    Object.assign(this, { number, revealed });
    const shown = { ...NEUTRAL, ...data.begin, ...this.step.show, ...(revealed ? this.step.reveal : {}) };
    const place = JSON.stringify([shown.scene, shown.camera]);
    if (place === this.camera) delete shown.camera; // as the reader turned it
    this.camera = place;
    this.shown = shown;
    if (narrow.matches) shown.show = shown.left === "figure" ? "order" : "both";
    else if (state.show !== "both") shown.show = "both";
    set(shown);
    this.speak(moved);
    try { history.replaceState(null, "", `#step=${number + 1}`); } catch { /* inside another page there is no address */ }
  }

  speak(moved) {
    const { steps, minutes } = this.meta, before = steps.slice(0, this.number).reduce((sum, step) => sum + step.minutes, 0);
    this.articles.forEach((article, i) => {
      article.hidden = i !== this.number;
      article.classList.toggle("revealed", i === this.number && this.revealed);
    });
    this.dots.forEach((dot, i) => dot.toggleAttribute("aria-current", i === this.number));
    $("talk-where").textContent = `${this.number + 1} of ${steps.length} · minute ${before} of ${minutes}`;
    $("talk-back").disabled = this.number === 0 && !this.revealed;
    $("talk-on").disabled = this.number + 1 === steps.length && !this.asking;
    $("talk-on").textContent = this.asking ? "answer" : "next";
    if (moved) $("words").scrollTop = 0;
    else this.articles[this.number].querySelector(".answer")?.scrollIntoView({ block: "nearest" });
  }
}
