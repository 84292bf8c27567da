// The operations of a DiamondProgram, under the names of DIAMOND_OP_TABLE in terrain/diamond/diamond_select.h. Truth
// is 1, else 0. Needs Vertex, diamond_rules.glsl and diamond_view.glsl.
// Units: metres, pixels, degrees. Bindings: storage 1 heights, 7 degrees.
// Defines: FIELD_DATUM and FIELD_DEGREES, for the operations that read them.
#ifdef FIELD_DATUM
layout(std430, binding = 1) readonly buffer DiamondDatum {
    float datum_m[];
};
float DIAMOND_OP_HEIGHT(Vertex vertex, int first) {
    return datum_m[vertex.entry];
}
#endif

#ifdef FIELD_DEGREES
layout(std430, binding = 7) readonly buffer DiamondDegrees {
    vec2 degrees[]; // east and north of the model's middle
};
float DIAMOND_OP_BOX(Vertex vertex, int first) {
    vec2 at = degrees[vertex.entry];
    vec4 sides = vec4(constant(first), constant(first + 1), constant(first + 2), constant(first + 3));
    return float(diamond_box(at.x, at.y, vertex.r, sides, vec2(constant(first + 4), constant(first + 5))));
}
#endif

vec3 constant3(int first) {
    return vec3(constant(first), constant(first + 1), constant(first + 2));
}

float DIAMOND_OP_CONSTANT(Vertex vertex, int first) {
    return constant(first);
}
float DIAMOND_OP_ERROR(Vertex vertex, int first) {
    return vertex.e;
}
float DIAMOND_OP_PX(Vertex vertex, int first) {
    return diamond_px(vertex.e, vertex.r, vertex.d2, view.lens.y, view.lens.x);
}
float DIAMOND_OP_DISTANCE(Vertex vertex, int first) {
    return diamond_root(vertex.d2);
}
float DIAMOND_OP_LEVEL(Vertex vertex, int first) {
    return float(vertex.level);
}
float DIAMOND_OP_STEP(Vertex vertex, int first) {
    return float(1 << vertex.plane);
}
float DIAMOND_OP_TAU(Vertex vertex, int first) {
    return view.lens.z;
}
float DIAMOND_OP_TOLERANCE(Vertex vertex, int first) {
    return float(diamond_tolerance(vertex.e, vertex.r, vertex.d2, view.eye.w, view.lens.x));
}
float DIAMOND_OP_INVIEW(Vertex vertex, int first) {
    return float(diamond_inview(vertex.v, vertex.r, view.lens.x, view.planes));
}
float DIAMOND_OP_WITHIN(Vertex vertex, int first) {
    return float(diamond_within(vertex.at, vertex.r, view.lens.x, constant3(first), constant3(first + 3),
                                constant3(first + 6), constant(first + 9)));
}

float DIAMOND_OP_ADD(float a, float b) {
    precise float sum = a + b;
    return sum;
}
float DIAMOND_OP_SUBTRACT(float a, float b) {
    precise float difference = a - b;
    return difference;
}
float DIAMOND_OP_MULTIPLY(float a, float b) {
    precise float product = a * b;
    return product;
}
float DIAMOND_OP_NEGATE(float a) {
    return -a;
}
float DIAMOND_OP_LESS(float a, float b) {
    return float(a < b);
}
float DIAMOND_OP_LESS_EQUAL(float a, float b) {
    return float(a <= b);
}
float DIAMOND_OP_GREATER(float a, float b) {
    return float(a > b);
}
float DIAMOND_OP_GREATER_EQUAL(float a, float b) {
    return float(a >= b);
}
float DIAMOND_OP_AND(float a, float b) {
    return float(a != 0.0 && b != 0.0);
}
float DIAMOND_OP_OR(float a, float b) {
    return float(a != 0.0 || b != 0.0);
}
float DIAMOND_OP_NOT(float a) {
    return float(a == 0.0);
}
