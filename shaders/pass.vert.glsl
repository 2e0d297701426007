// A triangle that covers the viewport: one fragment for each pixel.
void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    gl_Position = vec4(4.0f * corner - 1.0f, -1.0f, 1.0f); // at the near end of the depth range
}
