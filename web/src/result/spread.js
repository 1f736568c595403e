// Words that must not lie on each other.

/**
 * The places with those that are nearer to each other than `least` pushed apart, each as little as it takes.
 * @param places [x, y] each
 */
export function spread(places, least, rounds = 30) {
  const moved = places.map((place) => [...place]);
  for (let round = 0; round < rounds; round++) {
    let calm = true;
    for (let i = 0; i < moved.length; i++) {
      for (let j = 0; j < i; j++) {
        const [dx, dy] = [moved[i][0] - moved[j][0], moved[i][1] - moved[j][1]];
        const gap = Math.hypot(dx, dy);
        if (gap >= least * 0.999) continue;
        calm = false;
        const push = (least - gap) / 2;
        const [ux, uy] = gap > 0 ? [dx / gap, dy / gap] : [1, 0];
        moved[i] = [moved[i][0] + push * ux, moved[i][1] + push * uy];
        moved[j] = [moved[j][0] - push * ux, moved[j][1] - push * uy];
      }
    }
    if (calm) break;
  }
  return moved;
}
