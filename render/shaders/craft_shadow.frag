#version 450 core
// Depth is all that is kept. In, out: nothing.
void main() {
}
