// The arithmetic of one diamond and one super-square; the twin of terrain/diamond/diamond_rules.h, to the bit: single
// precision, + - * and comparisons only, nothing contracted.
// Units: metres from the model's origin, or from the eye where it says v.
const float DIAMOND_GROW = 1.00001, DIAMOND_FAR = 1e37, DIAMOND_HUGE_PX = 1e30;

// ---- generation

struct DiamondPlane { // of heights, through (0, 0, middle), dx and dy samples from the vertex
    float middle, rise_x, rise_y;
};

DiamondPlane diamond_edge_plane(float a, float b, float apex, float side, float inverse_step, bool horizontal) {
    precise float middle = 0.5 * (a + b);
    precise float along = (b - a) * (0.5 * inverse_step);
    precise float away = (apex - middle) * (side * inverse_step);
    return DiamondPlane(middle, horizontal ? along : away, horizontal ? away : along);
}

DiamondPlane diamond_west_plane(float nw, float ne, float sw, float se, float inverse_step, bool rising) {
    precise float scale = 0.5 * inverse_step;
    precise float middle = 0.5 * (rising ? sw + ne : nw + se);
    precise float rise_x = (rising ? ne - nw : se - sw) * scale;
    precise float rise_y = (sw - nw) * scale;
    return DiamondPlane(middle, rise_x, rise_y);
}

DiamondPlane diamond_east_plane(float nw, float ne, float sw, float se, float inverse_step, bool rising) {
    precise float scale = 0.5 * inverse_step;
    precise float middle = 0.5 * (rising ? sw + ne : nw + se);
    precise float rise_x = (rising ? se - sw : ne - nw) * scale;
    precise float rise_y = (se - ne) * scale;
    return DiamondPlane(middle, rise_x, rise_y);
}

uint diamond_deviation(float h, DiamondPlane plane, float dx, float dy) {
    precise float base = plane.middle + plane.rise_y * dy;
    precise float off = h - (base + plane.rise_x * dx);
    return floatBitsToUint(off) & 0x7FFFFFFFu;
}

float diamond_error(float deviation_m, float range_m, float drift, float sag_m) {
    precise float error_m = (deviation_m + range_m * drift) + sag_m;
    return error_m;
}

// ---- evaluation

float diamond_distance2(vec3 v) {
    precise float d2 = (v.x * v.x + v.y * v.y) + v.z * v.z;
    return d2;
}

float diamond_reach(float error_m, float reach_m, float slack_m) {
    precise float reach = error_m + (reach_m + slack_m);
    return reach;
}

bool diamond_tolerance(float error_m, float reach_m, float distance2, float nu, float slack_m) {
    precise float limit = nu * error_m + diamond_reach(error_m, reach_m, slack_m);
    precise float grown = (limit * limit) * DIAMOND_GROW;
    return grown > distance2;
}

float diamond_root(float square) {
    float x = square < DIAMOND_FAR ? square : DIAMOND_FAR;
    precise float half_x = 0.5 * x;
    precise float y = uintBitsToFloat(0x5F3759DFu - (floatBitsToUint(x) >> 1));
    y = y * (1.5 - (half_x * y) * y);
    y = y * (1.5 - (half_x * y) * y);
    y = y * (1.5 - (half_x * y) * y);
    y = y * (1.5 - (half_x * y) * y);
    precise float root = x * y;
    return root;
}

float diamond_reciprocal(float x) {
    precise float y = uintBitsToFloat(0x7EF311C7u - floatBitsToUint(x));
    y = y * (2.0 - x * y);
    y = y * (2.0 - x * y);
    y = y * (2.0 - x * y);
    y = y * (2.0 - x * y);
    return y;
}

float diamond_px(float error_m, float reach_m, float distance2, float px_per_rad, float slack_m) {
    precise float gap = diamond_root(distance2) * 0.99999 - diamond_reach(error_m, reach_m, slack_m);
    float least = gap > 0.001 ? gap : 0.001;
    precise float px = (px_per_rad * error_m) * (diamond_reciprocal(least) * DIAMOND_GROW);
    return gap > 0.001 && px < DIAMOND_HUGE_PX ? px : DIAMOND_HUGE_PX;
}

bool diamond_inview(vec3 v, float reach_m, float slack_m, vec4 planes[5]) {
    precise float room = (reach_m + slack_m) * DIAMOND_GROW;
    bool inside = true;
    for (int i = 0; i < 5; i++) {
        precise float ahead = (planes[i].x * v.x + planes[i].y * v.y) + planes[i].z * v.z;
        inside = inside && ahead >= -room;
    }
    return inside;
}

// The constants of the circle, c in C, as vectors: the place, east, north, and its radius.
bool diamond_within(vec3 at, float reach_m, float slack_m, vec3 place, vec3 to_east, vec3 to_north, float radius_m) {
    precise vec3 d = at - place;
    precise float east = (to_east.x * d.x + to_east.y * d.y) + to_east.z * d.z;
    precise float north = (to_north.x * d.x + to_north.y * d.y) + to_north.z * d.z;
    precise float limit = radius_m + (reach_m + slack_m);
    precise float square = east * east + north * north;
    precise float grown = (limit * limit) * DIAMOND_GROW;
    return square <= grown;
}

// The constants of the box, c in C: its sides, and the degrees that a metre can be.
bool diamond_box(float east_deg, float north_deg, float reach_m, vec4 sides, vec2 degrees) {
    precise float beside = reach_m * degrees.x, above = reach_m * degrees.y;
    precise float east = east_deg + beside, north = north_deg + above;
    precise float west = east_deg - beside, south = north_deg - above;
    return east >= sides.x && north >= sides.y && west <= sides.z && south <= sides.w;
}

// ---- closure

uint diamond_close_centres(uint own, uint east, uint south) {
    uint nw = own >> 1 | own >> 4 | own >> 6 | own >> 9;
    uint ne = own >> 3 | own >> 6 | own >> 11 | east >> 4;
    uint sw = own >> 9 | own >> 12 | own >> 14 | south >> 1;
    uint se = own >> 11 | own >> 14 | east >> 12 | south >> 3;
    return (nw & 1u) << 5 | (ne & 1u) << 7 | (sw & 1u) << 13 | (se & 1u) << 15;
}

uint diamond_close_edges(uint fine, uint west, uint north, int half_x, int half_y) {
    uint beside = fine >> 5 | fine >> 13 | west >> 7 | west >> 15;
    uint above = fine >> 5 | fine >> 7 | north >> 13 | north >> 15;
    return ((beside & 1u) << 4 | (above & 1u) << 1) << 8 * half_y + 2 * half_x;
}
