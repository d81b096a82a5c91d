// Axes on a canvas: a frame with ticks and titles, and lines in the coordinates of the axes.

const SUPERSCRIPTS = "⁰¹²³⁴⁵⁶⁷⁸⁹";

function power(exponent) {
  const digits = [...String(Math.abs(exponent))].map((digit) => SUPERSCRIPTS[digit]);
  return `10${exponent < 0 ? "⁻" : ""}${digits.join("")}`;
}

// Ticks at multiples of 1, 2 or 5 times a power of ten.
function linearTicks(low, high, most) {
  const rough = (high - low) / Math.max(1, most);
  const unit = 10 ** Math.floor(Math.log10(rough));
  const step = unit * ([1, 2, 5].find((factor) => factor * unit >= rough) ?? 10);
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) {
    const large = Math.abs(i * step) >= 1e6;
    const text = large ? (i * step).toExponential(1) : (i * step).toFixed(Math.min(decimals, 12));
    ticks.push({ at: i * step, text: text.replace("-", "−") });
  }
  return ticks;
}

// Decades, from exponent to exponent.
function decadeTicks(low, high, most) {
  const every = Math.max(1, Math.ceil((high - low) / Math.max(1, most)));
  const ticks = [];
  for (let exponent = Math.ceil(low); exponent <= high; exponent++) {
    if (exponent % every === 0) ticks.push({ at: exponent, text: power(exponent) });
  }
  return ticks;
}

export class Plot {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
  }

  // Clears the canvas and draws a frame: `x` and `y` are { low, high, title, isLog }. `isEqual` gives both axes one scale.
  frame({ x, y, isEqual }) {
    const { canvas, context } = this;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const style = getComputedStyle(document.documentElement);
    this.colour = (name) => style.getPropertyValue(`--${name}`).trim();
    this.box = { left: 62, top: 10, width: width - 62 - 12, height: height - 10 - 46 };
    const { left, top } = this.box;
    if (isEqual) this.#equalise(x, y);
    Object.assign(this, { x, y });

    context.font = "13px system-ui, sans-serif";
    context.lineWidth = 1;
    context.strokeStyle = this.colour("line");
    context.strokeRect(left, top, this.box.width, this.box.height);
    context.fillStyle = this.colour("faint");
    const ticks = (axis, most) => (axis.isLog ? decadeTicks : linearTicks)(axis.low, axis.high, most);
    context.textAlign = "center";
    context.textBaseline = "top";
    for (const { at, text } of ticks(x, Math.floor(this.box.width / 70))) {
      const place = this.acrossAt(at);
      this.#line([place, top, place, top + this.box.height], 0.5);
      context.fillText(text, place, top + this.box.height + 6);
    }
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const { at, text } of ticks(y, Math.floor(this.box.height / 34))) {
      const place = this.upAt(at);
      this.#line([left, place, left + this.box.width, place], 0.5);
      context.fillText(text, left - 6, place);
    }
    context.fillStyle = this.colour("text");
    context.textAlign = "center";
    context.textBaseline = "alphabetic";
    context.fillText(x.title, left + this.box.width / 2, height - 8);
    context.save();
    context.translate(14, top + this.box.height / 2);
    context.rotate(-Math.PI / 2);
    context.fillText(y.title, 0, 0);
    context.restore();
  }

  #equalise(x, y) {
    const scale = Math.max((x.high - x.low) / this.box.width, (y.high - y.low) / this.box.height);
    for (const [axis, length] of [[x, this.box.width], [y, this.box.height]]) {
      const missing = scale * length - (axis.high - axis.low);
      axis.low -= missing / 2;
      axis.high += missing / 2;
    }
  }

  #line([x0, y0, x1, y1], alpha) {
    const { context } = this;
    context.globalAlpha = alpha;
    context.beginPath();
    context.moveTo(x0, y0);
    context.lineTo(x1, y1);
    context.stroke();
    context.globalAlpha = 1;
  }

  acrossAt(x) {
    return this.box.left + ((x - this.x.low) / (this.x.high - this.x.low)) * this.box.width;
  }

  upAt(y) {
    return this.box.top + (1 - (y - this.y.low) / (this.y.high - this.y.low)) * this.box.height;
  }

  // Whatever `draw` draws, within the frame.
  within(draw) {
    const { context, box } = this;
    context.save();
    context.beginPath();
    context.rect(box.left, box.top, box.width, box.height);
    context.clip();
    draw(context);
    context.restore();
  }

  // A line through `count` points, each [x, y]; none where a point is undefined.
  line(count, point, { colour, width }) {
    this.within((context) => {
      context.strokeStyle = this.colour(colour);
      context.lineWidth = width;
      context.lineJoin = "round";
      context.beginPath();
      let isFirst = true;
      for (let i = 0; i < count; i++) {
        const at = point(i);
        if (at === undefined) continue;
        const [across, up] = [this.acrossAt(at[0]), this.upAt(at[1])];
        isFirst ? context.moveTo(across, up) : context.lineTo(across, up);
        isFirst = false;
      }
      context.stroke();
    });
  }

  dot(at, { colour, radius = 5, isHollow = false }) {
    this.within((context) => {
      context.beginPath();
      context.arc(this.acrossAt(at[0]), this.upAt(at[1]), radius, 0, 2 * Math.PI);
      context.fillStyle = context.strokeStyle = this.colour(colour);
      context.lineWidth = 2;
      isHollow ? context.stroke() : context.fill();
    });
  }

  // All below y, as a band with a text at its upper end.
  bandBelow(y, text) {
    const top = this.upAt(y);
    this.within((context) => {
      context.fillStyle = this.colour("band");
      context.fillRect(this.box.left, top, this.box.width, this.box.height);
      context.fillStyle = this.colour("text");
      context.textAlign = "right";
      context.textBaseline = "bottom";
      context.fillText(text, this.box.left + this.box.width - 8, top - 3);
    });
  }

  // Names of lines, in a row at the top of the frame.
  legend(entries) {
    const { context, box } = this;
    let left = box.left + 10;
    for (const { name, colour, width: lineWidth } of entries) {
      const width = 34 + context.measureText(name).width;
      context.fillStyle = this.colour("back");
      context.fillRect(left - 4, box.top + 5, width + 8, 22);
      context.strokeStyle = context.fillStyle = this.colour(colour);
      context.lineWidth = lineWidth;
      context.beginPath();
      context.moveTo(left, box.top + 16);
      context.lineTo(left + 26, box.top + 16);
      context.stroke();
      context.textAlign = "left";
      context.textBaseline = "middle";
      context.fillText(name, left + 32, box.top + 16);
      left += width + 16;
    }
  }
}
