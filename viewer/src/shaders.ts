/**
 * Deformation on the graphics card: x = p + U q, with the modes in a texture. Row i of `weights` has the number of weights of
 * instance i that are not zero, then (mode, weight) for each of these. So only modes with such weights cost time.
 */
export const vertexShader = /* glsl */ `
precision highp float;
precision highp int;
precision highp sampler2D;
in uint source;
uniform sampler2D modes;
uniform sampler2D weights;
uniform uint vertices;
uniform int modesShift;
flat out int triangle;
flat out int instance;
out vec3 seen;

void main() {
    vec3 x = position;
    int used = int(texelFetch(weights, ivec2(0, gl_InstanceID), 0).r);
    for (int i = 1; i <= used; i++) {
        vec2 weight = texelFetch(weights, ivec2(i, gl_InstanceID), 0).rg;
        int at = int(uint(weight.x) * vertices + source);
        int row = at >> modesShift;
        x += weight.y * texelFetch(modes, ivec2(at - (row << modesShift), row), 0).xyz;
    }
    // Copy i of a vertex is the last corner of triangle i and of no other: see corners.ts.
    triangle = gl_VertexID;
    instance = gl_InstanceID;
    vec4 view = modelViewMatrix * instanceMatrix * vec4(x, 1.0);
    seen = view.xyz;
    gl_Position = projectionMatrix * view;
}`;

/**
 * Cuts away the parts of the surface that hide the chosen pair: those that are nearer to the eye than the pair, in the cone from
 * the eye to a disc around the pair. `cut` has the middle of the disc in the world, and its radius; 0: nothing is cut.
 */
const cutAway = /* glsl */ `
uniform vec4 cut;

bool isCutAway() {
    if (cut.w <= 0.0) return false;
    vec3 middle = (viewMatrix * vec4(cut.xyz, 1.0)).xyz;
    float share = dot(seen, middle) / dot(middle, middle);
    return share < 1.0 && length(seen - share * middle) < share * cut.w;
}`;

/** The visible surface. Colliding triangles are striped, so they are distinct without colour vision. */
export const fragmentShader = /* glsl */ `
precision highp float;
precision highp int;
precision highp sampler2D;
flat in int triangle;
flat in int instance;
in vec3 seen;
uniform sampler2D marks;
uniform int marksShift;
uniform int triangles;
uniform sampler2D tints;
uniform sampler2D palette;
uniform bool tinted;
uniform bool plain;
uniform vec3 base;
uniform vec3 hit;
uniform vec3 hitDark;
uniform vec3 chosen;
uniform float stripe;
out vec4 colour;
${cutAway}

float mark() {
    int at = instance * triangles + triangle;
    int row = at >> marksShift;
    return texelFetch(marks, ivec2(at - (row << marksShift), row), 0).r * 255.0;
}

void main() {
    vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
    float light = 0.42 + 0.46 * max(dot(normal, normalize(vec3(-0.35, 0.6, 0.75))), 0.0)
        + 0.16 * max(dot(normal, normalize(vec3(0.8, -0.2, 0.5))), 0.0);
    float shine = pow(max(dot(normal, normalize(vec3(-0.2, 0.35, 0.95))), 0.0), 40.0) * 0.16;
    vec3 own = base;
    if (tinted && !plain) {
        int row = triangle >> 11;
        float tint = texelFetch(tints, ivec2(triangle - (row << 11), row), 0).r * 255.0;
        own = texelFetch(palette, ivec2(int(tint + 0.5), 0), 0).rgb;
    }
    float kind = plain ? 0.0 : mark();
    if (!plain && kind < 1.5 && isCutAway()) discard;
    if (kind > 0.5) {
        vec3 strong = kind > 1.5 ? chosen : hit;
        bool dark = fract((gl_FragCoord.x + gl_FragCoord.y) / stripe) < 0.33;
        colour = vec4((dark ? hitDark : strong) * (0.55 + 0.5 * light), 1.0);
    } else {
        colour = vec4(own * light + shine, 1.0);
    }
}`;

/** Colliding triangles behind others: they show through as a pale shade. */
export const hiddenShader = /* glsl */ `
precision highp float;
flat in int triangle;
flat in int instance;
in vec3 seen;
uniform vec3 hit;
uniform float stripe;
out vec4 colour;
void main() {
    if (fract((gl_FragCoord.x + gl_FragCoord.y) / stripe) < 0.33) discard;
    colour = vec4(hit, 0.42);
}`;

/**
 * A segment as a rectangle in the picture. Its points are moved toward the eye by a small share of their distance, which
 * leaves their place in the picture: otherwise the surface that contains them would hide half of them.
 */
export const curveVertexShader = /* glsl */ `
precision highp float;
in vec3 begin;
in vec3 end;
uniform vec2 size;
uniform float width;
out float across;

void main() {
    vec4 a = projectionMatrix * vec4((modelViewMatrix * vec4(begin, 1.0)).xyz * 0.9985, 1.0);
    vec4 b = projectionMatrix * vec4((modelViewMatrix * vec4(end, 1.0)).xyz * 0.9985, 1.0);
    if (a.w <= 0.0 || b.w <= 0.0) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
        return;
    }
    vec2 line = (b.xy / b.w - a.xy / a.w) * size;
    float far = length(line);
    vec2 along = far > 1e-6 ? line / far : vec2(1.0, 0.0);
    vec2 side = vec2(-along.y, along.x) * position.y + along * (2.0 * position.x - 1.0) * 0.4;
    vec4 at = position.x < 0.5 ? a : b;
    across = position.y;
    gl_Position = vec4(at.xy + side * width / size * at.w, at.zw);
}`;

export const curveFragmentShader = /* glsl */ `
precision highp float;
in float across;
uniform vec3 core;
uniform vec3 edge;
uniform float opacity;
out vec4 colour;
void main() {
    colour = vec4(abs(across) < 0.5 ? core : edge, opacity);
}`;
