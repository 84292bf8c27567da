// What belongs to super-squares, and the order of their vertices. Needs diamond.glsl.
// Units: metres. Bindings: storage 6.
layout(std430, binding = 6) readonly buffer DiamondSquares {
    uint squares[]; // three parts of as many words as there are super-squares: reach of the centres and of the edge
                    // midpoints, as floats, and the always-split bits
};

// Slots: centres (1,1) (3,1) (1,3) (3,3), edge midpoints (1,0) (3,0) (0,1) (2,1) (1,2) (3,2) (0,3) (2,3).
const int SLOT_BITS[12] = int[12](5, 7, 13, 15, 1, 3, 4, 6, 9, 11, 12, 14);

float centre_reach_m(int word) {
    return uintBitsToFloat(squares[word]);
}

float edge_reach_m(int word) {
    return uintBitsToFloat(squares[diamond.size.w + word]);
}

uint always_split(int word) {
    return squares[2 * diamond.size.w + word];
}
