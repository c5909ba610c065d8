// How far the point moved since the previous frame, in units of the picture's width and height.
vec2 motion_between(vec4 before, vec4 now) {
    return (now.xy / now.w - before.xy / before.w) * 0.5;
}
