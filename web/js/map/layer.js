/** A picture of what rests on the map, made anew only when its key changes. */

export class Layer {
  #canvas = new OffscreenCanvas(1, 1);
  #context = this.#canvas.getContext("2d", { alpha: false });
  #key = null;

  /** Copy the picture to `context`, of the same size; `draw(context)` makes it where `key` is new. */
  paint(context, key, draw) {
    const { width, height } = context.canvas;
    const whole = `${width} ${height} ${key}`;
    if (whole !== this.#key) {
      // Setting the size clears a canvas, so only if it differs.
      if (this.#canvas.width !== width) this.#canvas.width = width;
      if (this.#canvas.height !== height) this.#canvas.height = height;
      draw(this.#context);
      this.#key = whole;
    }
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.#canvas, 0, 0);
  }
}
