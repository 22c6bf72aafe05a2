// SPDX-License-Identifier: MIT
/// Items by their priority, the largest first. O(log n) each.
export class PriorityQueue<Item> {
  private readonly heap: { priority: number; item: Item }[] = [];

  push(item: Item, priority: number): void {
    const { heap } = this;
    let at = heap.length;
    heap.push({ priority, item });
    while (at > 0) {
      const above = (at - 1) >> 1;
      if (heap[above].priority >= priority) break;
      [heap[at], heap[above]] = [heap[above], heap[at]];
      at = above;
    }
  }

  pop(): Item | undefined {
    const { heap } = this;
    const first = heap[0];
    const last = heap.pop();
    if (first === undefined || last === undefined) return undefined;
    if (heap.length > 0) {
      heap[0] = last;
      this.sink();
    }
    return first.item;
  }

  private sink(): void {
    const { heap } = this;
    for (let at = 0; ; ) {
      let largest = at;
      for (const below of [2 * at + 1, 2 * at + 2])
        if (below < heap.length && heap[below].priority > heap[largest].priority) largest = below;
      if (largest === at) return;
      [heap[at], heap[largest]] = [heap[largest], heap[at]];
      at = largest;
    }
  }
}
