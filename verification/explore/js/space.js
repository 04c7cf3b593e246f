// Geometry of a tissue in space: images in a period, turns, and where a plane cuts the apical layer.

/** The image of a difference that is nearest to 0; a period of null is none. */
export function nearest(d, period) {
  return period ? d - period * Math.round(d / period) : d;
}

/** Where points are seen from: yaw around the vertical axis, then pitch; x to the right, y upwards, depth towards us. */
export function turned([yaw, pitch]) {
  const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  return (x, y, z) => {
    const right = cy * x + sy * z;
    const ahead = cy * z - sy * x;
    return [right, cp * y - sp * ahead, sp * y + cp * ahead];
  };
}

/** The points of a cell in the image whose basal point lies in the middle period: a function of the cell. */
export function images(head, a, where) {
  const [px, pz] = head.periods;
  const points = Array.from({ length: a.n }, (_, i) => {
    const [bx, bz] = [where("bx", i), where("bz", i)];
    const [dx, dz] = [nearest(bx, px) - bx, nearest(bz, pz) - bz];
    const at = (letter) => [where(`${letter}x`, i) + dx, where(`${letter}y`, i), where(`${letter}z`, i) + dz];
    return { nucleus: at(""), apical: at("a"), basal: at("b") };
  });
  return points;
}

/** The corners of each triangle of the apical layer, in one image: that of its first corner. */
export function triangles(head, a, points) {
  const [px, pz] = head.periods;
  const found = [];
  for (let k = 0; k < a.triangles.length; k += 3) {
    const [first, ...others] = [0, 1, 2].map((j) => points[a.triangles[k + j]].apical);
    const near = (point) => [
      first[0] + nearest(point[0] - first[0], px), point[1], first[2] + nearest(point[2] - first[2], pz),
    ];
    found.push([first, ...others.map(near)]);
  }
  return found;
}

/** The pieces in which the plane z = cut goes through triangles, or through their images: pairs of points (x, y, z). */
export function cutThrough(corners, cut, period) {
  const pieces = [];
  for (const three of corners) {
    const middle = (three[0][2] + three[1][2] + three[2][2]) / 3;
    const moved = middle - (cut + nearest(middle - cut, period));
    const above = three.map(([x, y, z]) => [x, y, z - moved]);
    const sides = above.map(([, , z]) => z > cut);
    const count = sides.filter(Boolean).length;
    if (count !== 1 && count !== 2) continue;
    const alone = above[sides.indexOf(count === 1)];
    const rest = above.filter((point) => point !== alone);
    pieces.push(rest.map((point) => {
      const part = (cut - alone[2]) / (point[2] - alone[2]);
      return [0, 1, 2].map((k) => alone[k] + part * (point[k] - alone[k]));
    }));
  }
  return pieces;
}
