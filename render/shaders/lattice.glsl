// Vertex positions as integers, exact until the difference to the eye is taken.
// Units: lattice units of 1/4096 m in, metres relative to the eye out, ECEF axes.
const float LATTICE_M = 1.0 / 4096.0;

// (page origin - eye) + vertex as a 64-bit sum, so that a vertex shared by two patches gives the same integer
// from both and therefore the same float, bit for bit. lo is unsigned, hi signed.
vec3 lattice_to_eye_m(ivec3 vertex, ivec3 origin_lo, ivec3 origin_hi, vec3 eye_rest_m) {
    uvec3 carry;
    ivec3 lo = ivec3(uaddCarry(uvec3(vertex), uvec3(origin_lo), carry));
    ivec3 hi = origin_hi + (vertex >> 31) + ivec3(carry);
    // As hi * 2^32 + lo with a signed lo, small differences have hi = 0 and lose nothing.
    hi -= lo >> 31;
    precise vec3 metres = vec3(hi) * (4294967296.0 * LATTICE_M) + vec3(lo) * LATTICE_M - eye_rest_m;
    return metres;
}
