// SPDX-License-Identifier: Apache-2.0
// The evaluation of a material on the GPU (WebGL 2). Names are those of the C++ and of
// docs/theory/evaluation.md, the reference: blend, fade, target, amplify, power, shape
// (synthesis/interpolate.cpp); displaced, s (evaluate.cpp).
// What a pixel costs: docs/theory/viewer_shader.md.
//
//     radiance = Σ_lights E/π max(0, offset + gain (x s)^power),   x = mean + Σ_r B_r φ_r(u)
//
// with barycentric weights w of subspaces in the triangles of measured directions [CAR2 §III],
// mean = Σ_k w_k mean_k and B = Σ_k w_k B_k of the textures, which are sums of the same few
// components φ (basis.ts), and the shading s of the surface.
//
// Renderers in software run both sides of an `if` and are slow at derivatives of coordinates:
// what skips work is a loop, and every level of detail is told.

precision highp float;
precision highp int;
precision highp usampler2D;

uniform sampler2D basis0;       // t of components 0 to 3, toroidal; then of 4 to 7, 8 to 11
uniform sampler2D basis1;
uniform sampler2D basis2;
uniform vec4 exponent[GROUPS];  // φ = S ψ, ψ = exp(exponent t) + offset
uniform vec4 offset[GROUPS];
uniform vec4 S_[GROUPS];
uniform sampler2D kept;         // column level: what of the variance of each group it keeps, and in w
                                // of the luminance's
uniform vec4 middle[GROUPS];    // mean of t in level 0 …
uniform vec4 farMiddle[GROUPS]; // … and where nothing of the variance is left
uniform sampler2D subspaces;    // row k; columns: S B of red, green, blue of each group, then mean
                                // and shape of TextureMoments
uniform sampler2D skies;        // row v: mean colour of view v under light from everywhere
uniform vec4 skyRows[3 * GROUPS]; // S B of each group under it in means of red, green, blue
uniform usampler2D viewCells;   // triangulated views: core/direction_mesh.hpp
uniform usampler2D lightCells;  // the same of lights
uniform sampler2D pairs;        // of every pair, lights outermost: e of the bands; in w bytes of a whole
                                // number, subspace, ∛z of the light, e of the contrast
uniform float contrastScale;    // of the latter
uniform sampler2D surface;      // (N + 1) / 2 of the unit normal, height from smallest to largest; a torus
uniform sampler2D heights;      // the same with the nearest level alone
uniform sampler2D moments;      // by l, over the surface: E t of t = max(0, N·l) + a E max(0, N·l), C_t, h_t
uniform float leastShading;     // a / (1 + a): light from elsewhere, where the lamp does not reach
uniform sampler2D cells0;       // mean of t of the components by the pattern's phase
uniform sampler2D cells1;
uniform sampler2D cells2;
uniform sampler2D phase;        // B⁻¹ D of the pattern, toroidal like the components
uniform vec4 latticeInverse;    // B⁻¹ by rows, (row, column) to phases
uniform vec4 lattice;           // B by rows, phases to (s, t) of the torus
uniform vec4 warp;              // by rows: a torus that the lattice closes on is stretched back
uniform float cellLevel;        // level of a cell's table less that of the texture
uniform vec2 surfaceSize;       // of its torus, in texels
uniform vec2 fieldSize;         // of the torus of components, in texels
uniform vec2 texelsPerUv;
uniform vec2 heightRange;       // smallest and largest height, in texels
uniform float relief;           // scale of heights; 0 switches relief off
uniform bool marched;           // displacement and self-shadow, not shading alone
uniform vec3 tint;
uniform float exposure;
uniform int viewMode;           // VIEW_*
uniform vec3 palette[SUBSPACES];

// Loops over arrays are written out: renderers in software are slow at any index but a constant.
#if GROUPS == 1
#define EACH_GROUP(f) f(0)
#elif GROUPS == 2
#define EACH_GROUP(f) f(0) f(1)
#else
#define EACH_GROUP(f) f(0) f(1) f(2)
#endif

varying vec2 vUv;
varying vec3 vNormal;
varying vec3 vViewPosition;

const int VIEW_COMBINED = 0;
const int VIEW_SMOOTH = 1;
const int VIEW_RELIEF = 2;
const int VIEW_INDEX = 3;

const vec3 LUMINANCE = vec3(0.2126390059, 0.7151686788, 0.0721923154);

// ---------------------------------------------------------------- directions

struct Corners {
    ivec3 number;
    vec3 w;
};

uvec4 in_list(usampler2D list, int at) {
    return texelFetch(list, ivec2(at & (LIST_COLS - 1), at >> LIST_SHIFT), 0);
}

// DirectionMesh::interpolate: the square of the stereographic map (x, y) / (1 + z) that d is in
// names a cell, from which a walk leads across the border that d is furthest beyond. The weights
// are s_k = row_k · d, of sum 1; past the rim (in a sector) the third counts as 0.
Corners corners_of(usampler2D mesh, vec3 d) {
    vec2 at = clamp((d.xy / (1.0 + d.z) * 0.5 + 0.5) * float(START_SIDE), 0.0, float(START_SIDE - 1));
    int square = int(at.y) * START_SIDE + int(at.x);
    uvec4 four = in_list(mesh, square >> 2);
    int cell = int(four[square & 3]);
    uvec4 a, b, c;
    vec3 s;
    for (int walk = 0; walk < 8; ++walk) {
        int first = START_SIDE * START_SIDE / 4 + 3 * cell;
        a = in_list(mesh, first);
        b = in_list(mesh, first + 1);
        c = in_list(mesh, first + 2);
        s = vec3(dot(uintBitsToFloat(a.xyz), d), dot(uintBitsToFloat(b.xyz), d), dot(uintBitsToFloat(c.xyz), d));
        if (min(s.x, min(s.y, s.z)) >= -1e-5) break;
        cell = int((s.x <= min(s.y, s.z) ? a.w : s.y <= s.z ? b.w : c.w) >> 16);
    }
    if ((c.w & 0x8000u) != 0u) s.z = 0.0;
    s = max(s, 0.0);
    float sum = s.x + s.y + s.z;
    return Corners(ivec3(uvec3(a.w, b.w, c.w) & 0x7FFFu), sum > 0.0 ? s / sum : vec3(1.0, 0.0, 0.0));
}

// ---------------------------------------------------------------- components without repetition

// Three tiles with shifts by hash overlap at every place of a triangular grid. Their sum,
// weighted by w with the variance kept, is a Gaussian field again [Heitz & Neyret 2018]:
//     g = ḡ + Σ w_i (g_i - ḡ),   Σ w_i² = 1
// The largest weight comes first; near a vertex the others are 0, and not read.
struct Tiles {
    vec2 at0, at1, at2;
    vec3 w;
};

uvec2 tile_hash(ivec2 vertex) {
    uvec2 v = uvec2(vertex) * uvec2(0x9E3779B9u, 0x85EBCA6Bu);
    uint h = v.x ^ (v.y + (v.x << 6) + (v.x >> 2));
    h ^= h >> 16; h *= 0x7FEB352Du; h ^= h >> 15; h *= 0x846CA68Bu; h ^= h >> 16;
    return uvec2(h & 0xFFFFu, h >> 16);
}

// Anywhere on the torus; of a pattern, by whole cells.
vec2 tile_shift(ivec2 vertex) {
    uvec2 h = tile_hash(vertex);
#ifdef PATTERN
    vec2 cell = vec2(h & 31u);
    return fract(vec2(dot(lattice.xy, cell), dot(lattice.zw, cell)));
#else
    return vec2(h) / 65536.0;
#endif
}

void order(inout float w0, inout float w1, inout ivec2 a, inout ivec2 b) {
    if (w0 < w1) {
        float w = w0; w0 = w1; w1 = w;
        ivec2 v = a; a = b; b = v;
    }
}

Tiles tiles_at(vec2 st) {
    Tiles t;
#ifdef REPEAT
    t.at0 = t.at1 = t.at2 = st;
    t.w = vec3(1.0, 0.0, 0.0);
#else
    const float EDGES = 1.5;  // of the grid along a tile: longer waves than its edge are lost
    const float ALONE = 0.25; // the weight from which a tile counts
    vec2 skewed = mat2(1.0, 0.0, -0.57735027, 1.15470054) * (st * EDGES);
    ivec2 base = ivec2(floor(skewed));
    vec3 f = vec3(fract(skewed), 0.0);
    f.z = 1.0 - f.x - f.y;
    bool upper = f.z <= 0.0;
    ivec2 a = upper ? base + 1 : base;
    ivec2 b = base + (upper ? ivec2(1, 0) : ivec2(0, 1));
    ivec2 c = base + (upper ? ivec2(0, 1) : ivec2(1, 0));
    t.w = upper ? vec3(-f.z, 1.0 - f.y, 1.0 - f.x) : f.zyx;
    order(t.w.x, t.w.y, a, b);
    order(t.w.x, t.w.z, a, c);
    order(t.w.y, t.w.z, b, c);
    t.w = max(t.w - ALONE, 0.0);
    t.w /= length(t.w);
    t.at0 = st + tile_shift(a);
    t.at1 = st + tile_shift(b);
    t.at2 = st + tile_shift(c);
#endif
    return t;
}

#ifdef PATTERN
// u(x) = B⁻¹ (x + D(x)): D is a Gaussian field as well, and blended with the others. Each tile is
// then read where it has this phase.
vec2 align_phases(vec2 texel, inout Tiles t, float level) {
    vec2 d0 = textureLod(phase, t.at0, level).xy;
    vec2 shift = d0;
#ifndef REPEAT
    vec2 d1 = textureLod(phase, t.at1, level).xy;
    vec2 d2 = textureLod(phase, t.at2, level).xy;
    shift = t.w.x * d0 + t.w.y * d1 + t.w.z * d2;
    mat2 B = mat2(lattice.xz, lattice.yw);
    t.at0 += B * (shift - d0);
    t.at1 += B * (shift - d1);
    t.at2 += B * (shift - d2);
#endif
    vec2 x = texel.yx - 0.5;  // (row, column); pixels are whole numbers there
    return vec2(dot(latticeInverse.xy, x), dot(latticeInverse.zw, x)) + shift;
}
#endif

// ψ of all components at a place.
struct Components {
    vec4 c[GROUPS];
    float kept;     // of the luminance's variance
};

// \param dx, dy  how the place moves from pixel to pixel
Components components_at(vec2 texel, vec2 dx, vec2 dy, float level) {
#if ANISOTROPY > 1
#define component(group, at) textureGrad(group, at, dx / fieldSize, dy / fieldSize)
#else
#define component(group, at) textureLod(group, at, level)
#endif
    Components p;
#ifdef PATTERN
    texel = vec2(dot(warp.xy, texel), dot(warp.zw, texel));
#endif
    Tiles t = tiles_at(texel / fieldSize);
    float column = (clamp(level, 0.0, float(LEVELS - 1)) + 0.5) / float(LEVELS);
#ifdef PATTERN
    vec2 u = align_phases(texel, t, level).yx;
#define MIDDLE(j, cells) textureLod(cells, u, level + cellLevel)
#else
    // Of lognormal values the logarithm of the mean moves with the variance.
#define MIDDLE(j, cells) mix(farMiddle[j], middle[j], share[j])
#endif
    vec4 share = textureLod(kept, vec2(column, 0.5), 0.0);
    p.kept = share.w;
#ifdef REPEAT
    p.c[0] = component(basis0, t.at0);
#if GROUPS > 1
    p.c[1] = component(basis1, t.at0);
#endif
#if GROUPS > 2
    p.c[2] = component(basis2, t.at0);
#endif
#else
    float rest = 1.0 - t.w.x - t.w.y - t.w.z;
    p.c[0] = rest * MIDDLE(0, cells0);
#if GROUPS > 1
    p.c[1] = rest * MIDDLE(1, cells1);
#endif
#if GROUPS > 2
    p.c[2] = rest * MIDDLE(2, cells2);
#endif
    for (int i = 0; i < 3 && t.w.x > 0.0; ++i) {
        p.c[0] += t.w.x * component(basis0, t.at0);
#if GROUPS > 1
        p.c[1] += t.w.x * component(basis1, t.at0);
#endif
#if GROUPS > 2
        p.c[2] += t.w.x * component(basis2, t.at0);
#endif
        t.at0 = t.at1;
        t.at1 = t.at2;
        t.w = vec3(t.w.yz, 0.0);
    }
#endif
#define CURVE(j) p.c[j] = exp(exponent[j] * p.c[j]) + offset[j];
    EACH_GROUP(CURVE)
    return p;
}

// ---------------------------------------------------------------- surface

float height_at(vec2 texel, float level) {
    return relief * mix(heightRange.x, heightRange.y, textureLod(heights, texel / surfaceSize, level).w);
}

// How many steps a ray takes between the highest and the lowest height: one a texel of the level
// that it passes over, so that flat and distant surfaces cost little.
int steps_over(vec2 slope, float depth, float level, int most) {
    return int(min(ceil(length(slope) * depth * exp2(-max(level, 0.0))), float(most)));
}

// Where the ray towards the eye leaves the surface: `displaced` of evaluate.hpp, by a linear
// search and a secant step. `texel` is where it meets the plane of height 0.
vec3 relief_hit(vec2 texel, vec3 view, float level) {
    vec2 slope = vec2(view.x, -view.y) / max(view.z, 0.1);
    float top = relief * heightRange.y;
    float depth = top - relief * heightRange.x;
    int steps = steps_over(slope, depth, level, RELIEF_STEPS);
    float z = top;
    float step_size = depth / float(max(steps, 1));
    float above = 0.0;
    for (int i = 0; i <= steps; ++i) {
        float next = top - step_size * float(i);
        float below = next - height_at(texel + slope * next, level);
        if (below <= 0.0) {
            z = i == 0 ? next : next + step_size * (-below / max(above - below, 1e-6));
            break;
        }
        above = below;
        z = next;
    }
    return vec3(texel + slope * z, z);
}

// 1 in light, 0 where the surface hides the light: is_shadowed, with a soft edge.
float self_shadow(vec3 hit, vec3 light, float level) {
    vec2 slope = vec2(light.x, -light.y) / max(light.z, 0.1);
    float depth = relief * (heightRange.y - heightRange.x);
    float start = hit.z + 0.01 * depth;
    float rise = relief * heightRange.y - start;
    int steps = steps_over(slope, rise, level, SHADOW_STEPS);
    float over = -depth;
    for (int i = 1; i <= steps; ++i) {
        float up = rise * float(i) / float(steps);
        over = max(over, height_at(hit.xy + slope * up, level) - start - up);
    }
    return 1.0 - clamp(over / (0.01 * depth + 1e-4), 0.0, 1.0);
}

// Mean over a pixel of max(0, N·l): N is the mean of the pixel's normals, whose length tells how
// much they vary; for a Gaussian N·l of mean μ and variance v it is near ½(μ + √(μ² + 2v/π)).
float lit(vec3 N, vec3 light, float level) {
    float mean = dot(N, light);
    float spread = level > 0.0 ? max(0.0, 1.0 - dot(N, N)) * (1.0 - 0.5 * light.z * light.z) * 0.5 : 0.0;
    return 0.5 * (mean + sqrt(mean * mean + spread * 0.63661977));
}

// E t, C_s = ln(E t² / (E t)²), h_s = -8 ln(E √t / √E t).
vec3 shading_moments(vec3 light) {
    vec2 at = (light.xy / (1.0 + max(light.z, 0.0)) * 0.5 + 0.5) * float(MOMENT_SIDE - 1) + 0.5;
    return textureLod(moments, at / float(MOMENT_SIDE), 0.0).xyz;
}

// ---------------------------------------------------------------- interpolation

#ifdef MEASURED
// The weights of the pairs of the nearest three lights and views, and their subspaces: row i is
// of light i. Subspaces are whole numbers, or -1 where they have no weight.
struct Pairs {
    vec3 w0, w1, w2;
    vec3 k0, k1, k2;
    vec4 e;          // encoded mean colour and contrast
    float fade;
};

// Adds a pair. \param z  of its light, and ∛z; weighted
float add_pair(int at, float w, inout vec4 e, inout vec2 z) {
    vec4 pair = texelFetch(pairs, ivec2(at & (LIST_COLS - 1), at >> LIST_SHIFT), 0);
    float k = floor(pair.w * (1.0 / 65536.0));
    float rest = pair.w - 65536.0 * k;
    float root = floor(rest * (1.0 / 256.0));
    e += w * vec4(pair.xyz, rest - 256.0 * root);
    root *= 1.0 / 255.0;
    z += w * vec2(root * root * root, root);
    return k;
}

vec3 add_pairs(int light, vec3 w, ivec3 view, inout vec4 e, inout vec2 z) {
    ivec3 at = light * VIEWS + view;
    return vec3(add_pair(at.x, w.x, e, z), add_pair(at.y, w.y, e, z), add_pair(at.z, w.z, e, z));
}

// Steps 1 to 3 of DirectionalInterpolation::at.
Pairs interpolate(Corners view, vec3 light) {
    Pairs p;
    p.e = vec4(0.0);
    p.fade = light.z;
    Corners l = corners_of(lightCells, light);
    vec2 z = vec2(0.0);
    p.w0 = l.w.x * view.w;
    p.w1 = l.w.y * view.w;
    p.w2 = l.w.z * view.w;
    p.k0 = add_pairs(l.number.x, p.w0, view.number, p.e, z);
    p.k1 = add_pairs(l.number.y, p.w1, view.number, p.e, z);
    p.k2 = add_pairs(l.number.z, p.w2, view.number, p.e, z);
    p.e.w *= contrastScale;
#ifdef COSINE_INCLUDED
#ifdef REFLECTANCE
    p.fade = min(4.0, light.z / max(z.y * z.y * z.y, 1e-3));
#else
    p.fade = min(4.0, light.z / max(z.x, 1e-3));
#endif
#endif
    return p;
}

// What does not count is not read: pairs of weights below FAINT.
void leave_out_faint(inout Pairs p) {
    const float FAINT = 0.02;
    p.w0 = max(p.w0 - FAINT, 0.0);
    p.w1 = max(p.w1 - FAINT, 0.0);
    p.w2 = max(p.w2 - FAINT, 0.0);
    float scale = 1.0 / dot(p.w0 + p.w1 + p.w2, vec3(1.0));
    p.w0 *= scale;
    p.w1 *= scale;
    p.w2 *= scale;
    p.k0 = mix(vec3(-1.0), p.k0, vec3(greaterThan(p.w0, vec3(0.0))));
    p.k1 = mix(vec3(-1.0), p.k1, vec3(greaterThan(p.w1, vec3(0.0))));
    p.k2 = mix(vec3(-1.0), p.k2, vec3(greaterThan(p.w2, vec3(0.0))));
}

// The largest number of a subspace that has weight, or -1.
float next_subspace(Pairs p) {
    vec3 most = max(p.k0, max(p.k1, p.k2));
    return max(most.x, max(most.y, most.z));
}

// The weight of all pairs of subspace k, which are then out.
float take_weight(inout Pairs p, float k) {
    vec3 of0 = max(1.0 - abs(p.k0 - k), 0.0);
    vec3 of1 = max(1.0 - abs(p.k1 - k), 0.0);
    vec3 of2 = max(1.0 - abs(p.k2 - k), 0.0);
    p.k0 -= of0 * (k + 1.0);
    p.k1 -= of1 * (k + 1.0);
    p.k2 -= of2 * (k + 1.0);
    return dot(of0, p.w0) + dot(of1, p.w1) + dot(of2, p.w2);
}
#endif

vec4 in_subspace(int k, int column) {
    return texelFetch(subspaces, ivec2(column, k), 0);
}

#ifdef MEASURED
// The value of the place for one light: steps 4 to 6, max(0, offset + gain (x s)^power).
// A mip level that keeps a share of the variance keeps as much of what the power takes off the mean.
// \param s  shading of mean 1;  C_s, h_s  ln(E s² / (E s)²) and -8 ln(E √s / √E s) over the surface
vec3 value_for(Pairs p, Components psi, float s, float C_s, float h_s) {
    vec4 mean = vec4(0.0);
    vec4 shape = vec4(0.0);
    vec3 x = vec3(0.0);
    vec4 F[GROUPS];
#define CLEAR(j) F[j] = vec4(0.0);
    EACH_GROUP(CLEAR)
    leave_out_faint(p);
    for (float next = next_subspace(p); next >= 0.0; next = next_subspace(p)) {
        int k = int(next);
        float w = take_weight(p, next);
        vec4 red, green, blue;
#define ADD(j) \
        red = w * in_subspace(k, 3 * j); \
        green = w * in_subspace(k, 3 * j + 1); \
        blue = w * in_subspace(k, 3 * j + 2); \
        x += vec3(dot(red, psi.c[j]), dot(green, psi.c[j]), dot(blue, psi.c[j])); \
        F[j] += LUMINANCE.x * red + LUMINANCE.y * green + LUMINANCE.z * blue;
        EACH_GROUP(ADD)
        vec4 own = in_subspace(k, 3 * GROUPS);
        mean += w * own;
#ifdef REFLECTANCE
        shape += w * dot(LUMINANCE, own.xyz) * in_subspace(k, 3 * GROUPS + 1);
#endif
    }
    x = max(mean.xyz + x, 0.0) * s;
#ifdef REFLECTANCE
    vec3 e = max(p.e.xyz, 0.0);
    vec3 target = p.fade * e * e * e;
    vec3 m = max(mean.xyz, 1e-6);
    float Y = dot(LUMINANCE, m);
    float variance = 0.0;
#define VARIANCE(j) F[j] /= S_[j]; variance += dot(F[j], F[j]);
    EACH_GROUP(VARIANCE)
    shape /= Y;
    float C = log(1.0 + variance / (Y * Y));
    float h = C + C * C * shape.w;
    C = max(C + C_s, 1e-6);
    float H = clamp(h + h_s, 0.5 * C, 2.83 * C);
    float q = log2(4.0 * C / H);
    float wanted = max(0.0, p.e.w);
    float power = clamp(pow(log(1.0 + wanted * wanted) / C, 1.0 / q), 0.5, 1.0);
    float amplify = min(3.0, wanted / sqrt(max(exp(C * pow(power, q)) - 1.0, 1e-6)));
    vec3 c = (shape.xyz * h + h_s) * (1.0 + (C / H - 1.0) * (power - 0.5) / 1.5);
    // (x/m)^power / E, E = exp(-½ power (1 - power) c)
    vec3 t = exp(power * log(max(x / m, 1e-6)) + 0.5 * power * (1.0 - power) * psi.kept * c);
    return max(vec3(0.0), target * (1.0 - amplify + amplify * t));
#else
    return p.fade * x;
#endif
}

// The colours of the subspaces, by their weights.
vec3 palette_of(Pairs p) {
    vec3 sum = vec3(0.0);
    leave_out_faint(p);
    for (float k = next_subspace(p); k >= 0.0; k = next_subspace(p)) sum += take_weight(p, k) * palette[int(k)];
    return sum;
}
#endif

// The value under light from everywhere, of irradiance 1: the mean over the lights measured of the
// view's colours, and of the textures of all pairs relative to them.
vec3 sky_value(Corners view, Components psi) {
#ifdef MEASURED
    vec3 colour = vec3(0.0);
    vec3 relative = vec3(0.0);
    colour += view.w.x * texelFetch(skies, ivec2(0, view.number.x), 0).xyz;
    colour += view.w.y * texelFetch(skies, ivec2(0, view.number.y), 0).xyz;
    colour += view.w.z * texelFetch(skies, ivec2(0, view.number.z), 0).xyz;
#define OF_SKY(j) \
    relative += vec3(dot(skyRows[3 * j], psi.c[j]), dot(skyRows[3 * j + 1], psi.c[j]), dot(skyRows[3 * j + 2], psi.c[j]));
    EACH_GROUP(OF_SKY)
    return colour * max(1.0 + relative, 0.0);
#else
    vec3 x = in_subspace(0, 3 * GROUPS).xyz;
#define OWN(j) \
    x += vec3(dot(in_subspace(0, 3 * j), psi.c[j]), dot(in_subspace(0, 3 * j + 1), psi.c[j]), dot(in_subspace(0, 3 * j + 2), psi.c[j]));
    EACH_GROUP(OWN)
    return max(x, 0.0);
#endif
}

// ---------------------------------------------------------------- a pixel

mat3 tangent_frame(vec3 N) {
    vec3 q0 = dFdx(vViewPosition);
    vec3 q1 = dFdy(vViewPosition);
    vec2 st0 = dFdx(vUv);
    vec2 st1 = dFdy(vUv);
    vec3 T = -(cross(q1, N) * st0.x + cross(N, q0) * st1.x);
    T -= N * dot(N, T);
    T = dot(T, T) < 1e-20 ? normalize(cross(vec3(0.0, 1.0, 0.0), N)) : normalize(T);
    return mat3(T, cross(N, T), N);
}

vec3 sateen_radiance() {
    vec3 N = normalize(vNormal);
#ifdef DOUBLE_SIDED
    N *= gl_FrontFacing ? 1.0 : -1.0;
#endif
    mat3 frame = tangent_frame(N);
    vec3 view = normalize(vViewPosition) * frame;
    view = normalize(vec3(view.xy, max(view.z, 0.001)));

    // Rows of textures run downwards.
    vec2 texel = vec2(vUv.x, -vUv.y) * texelsPerUv;
    vec2 dx = dFdx(texel);
    vec2 dy = dFdy(texel);
    // The longer axis of a pixel's footprint, unless it is ANISOTROPY times the shorter.
    vec2 axes = vec2(dot(dx, dx), dot(dy, dy));
    float fine = 0.5 * log2(max(min(axes.x, axes.y), 1e-8));  // of the relief, along the shorter axis
    float level = 0.5 * log2(max(max(min(axes.x, axes.y), max(axes.x, axes.y) / float(ANISOTROPY * ANISOTROPY)), 1e-8));

    vec3 normal = vec3(0.0, 0.0, 1.0);
    vec3 hit = vec3(texel, 0.0);
    bool rough = false;
#ifdef SURFACE
    rough = relief > 0.0 && viewMode != VIEW_SMOOTH && viewMode != VIEW_INDEX;
    if (rough) {
        if (marched) hit = relief_hit(texel, view, fine);
        vec3 n = textureLod(surface, hit.xy / surfaceSize, fine).xyz * (255.0 / 127.0) - 1.0;
        float size = dot(n, n);
        normal = vec3(relief * n.xy, n.z);
        normal *= sqrt(size / dot(normal, normal));
    }
#endif

    Corners view_corners = Corners(ivec3(0), vec3(1.0, 0.0, 0.0));
#ifdef MEASURED
    view_corners = corners_of(viewCells, view);
#endif

    Components psi = components_at(hit.xy, dx, dy, level);

    vec3 radiance = vec3(0.0);
    vec3 ambient = ambientLightColor;
#if NUM_HEMI_LIGHTS > 0
    vec3 bent = frame * normalize(normal);
    for (int i = 0; i < NUM_HEMI_LIGHTS; ++i)
        ambient += getHemisphereLightIrradiance(hemisphereLights[i], bent);
#endif
    vec3 everywhere = sky_value(view_corners, psi);
    if (viewMode == VIEW_RELIEF) radiance = 0.5 * ambient;
    else if (viewMode != VIEW_INDEX) radiance = ambient * everywhere;
#if NUM_DIR_LIGHTS > 0
    for (int i = 0; i < NUM_DIR_LIGHTS; ++i) {
        vec3 irradiance = directionalLights[i].color;
        vec3 light = directionalLights[i].direction * frame;
        if (light.z <= 0.0) continue;
        float s = 1.0;
        float C_s = 0.0;
        float h_s = 0.0;
        float clay = light.z;
#ifdef SURFACE
        if (rough) {
            float shadow = marched ? self_shadow(hit, light, fine) : 1.0;
            clay = lit(normal, light, fine) * shadow;
#ifdef DELIT
            vec3 mean = shading_moments(light);
            s = lit(normal, light, fine) / mean.x;
            C_s = mean.y;
            h_s = mean.z;
#endif
            s *= shadow;
#ifdef DELIT
            s += leastShading;
#endif
        }
#endif
        if (viewMode == VIEW_RELIEF) {
            radiance += 0.5 * irradiance * clay;
            continue;
        }
#ifdef MEASURED
        Pairs p = interpolate(view_corners, light);
        if (viewMode == VIEW_INDEX) {
            radiance = palette_of(p);
            continue;
        }
        radiance += irradiance * value_for(p, psi, s, C_s, h_s);
#else
        radiance += irradiance * light.z * s * everywhere;
#endif
    }
#endif
    if (viewMode == VIEW_INDEX) return radiance;
    const float RECIPROCAL_PI_ = 0.3183098861837907;
    return exposure * (viewMode == VIEW_RELIEF ? vec3(1.0) : tint) * radiance * RECIPROCAL_PI_;
}
