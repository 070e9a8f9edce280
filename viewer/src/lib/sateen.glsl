// SPDX-License-Identifier: Apache-2.0
// The evaluation of a material on the GPU (WebGL 2). Names are those of the C++ and of
// docs/theory/evaluation.md, the reference: g, q, T, mean, tone (synthesis/appearance.cpp);
// blend, fade, target, amplify, power (synthesis/interpolate.cpp); displaced, s (evaluate.cpp).
// What a pixel costs: docs/theory/viewer_shader.md.
//
//     radiance = Σ_lights E/π max(0, offset + gain (x s)^power),   x = Σ_k w_k v_k(u)
//
// with barycentric weights w of subspaces in the triangles of measured directions [CAR2 §III],
// the texture v_k of each, and the shading s of the surface.
//
// Renderers in software run both sides of an `if` and are slow at arrays that are indexed by
// numbers of a pixel: what skips work is a loop, and weights are kept in vectors.

precision highp float;
precision highp int;
precision highp sampler2DArray;
precision highp usampler2D;

uniform sampler2DArray fields;  // layer k: g of every plane, toroidal, (g + G) / 2G
uniform sampler2D curves;       // rows (k, level): q(g) of every plane
uniform sampler2D hidden;       // column k, row level: variance of each band that the level hides,
                                // and the share of the luminance's variance that it keeps
uniform usampler2D viewCells;   // triangulated views: core/direction_mesh.hpp
uniform usampler2D lightCells;  // the same of lights, then (z, ∛z) of every light
uniform usampler2D pairs;       // e of every pair and its subspace, lights outermost
uniform sampler2D surface;      // unit normal N, height h in texels; a torus
uniform sampler2D moments;      // means of s = max(0, N·l), s², √s over the surface, by l
uniform sampler2DArray cells;   // layers 3k, 3k + 1, 3k + 2: m, s and l of the pattern
uniform sampler2D phase;        // B⁻¹ D, toroidal like the fields
uniform sampler2D toneCurves;   // rows (k, level): c of every plane of the pattern
uniform vec4 subspaces[SUBSPACES * SUBSPACE_ROWS];
uniform vec4 latticeInverse;    // B⁻¹ by rows
uniform vec2 surfaceSize;       // of its torus, in texels
uniform vec2 fieldSize;         // of the torus of fields, in texels
uniform vec2 texelsPerUv;
uniform vec2 heightRange;       // smallest and largest height, in texels
uniform float relief;           // scale of heights; 0 switches relief off
uniform bool marched;           // displacement and self-shadow, not shading alone
uniform vec3 tint;
uniform float exposure;
uniform int viewMode;           // VIEW_*
uniform vec3 palette[SUBSPACES];

varying vec2 vUv;
varying vec3 vNormal;
varying vec3 vViewPosition;

const int VIEW_COMBINED = 0;
const int VIEW_SMOOTH = 1;
const int VIEW_RELIEF = 2;
const int VIEW_INDEX = 3;

const float G = 4.2;            // g runs from -G to G …
const float G_NODES = 85.0;     // … in nodes 0.1 apart, which all knots of a marginal are
const vec3 LUMINANCE = vec3(0.2126390059, 0.7151686788, 0.0721923154);

// Rows of each in `subspaces`; the first three are T.
const int ROW_MEAN = 3;         // of the transform; tone in w
const int ROW_TEXTURE = 4;      // mean of the texture
const int ROW_COVARIANCE = 5;   // F: covariance of luminances j and k is F_j · F_k
const int ROW_SHAPE = 6;        // TextureMoments::shape
const int ROW_LOW = 7;          // of the tone curves: first abscissa of each plane
const int ROW_SCALE = 8;        // and 1 over their length

// ---------------------------------------------------------------- directions

struct Corners {
    ivec3 number;
    vec3 w;
};

uvec4 in_list(usampler2D list, int at) {
    return texelFetch(list, ivec2(at % LIST_COLS, at / LIST_COLS), 0);
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

// ---------------------------------------------------------------- fields without repetition

// Three tiles with shifts by hash overlap at every place of a triangular grid. Their sum,
// weighted by w with the variance kept, is a Gaussian field again [Heitz & Neyret 2018]:
//     g = Σ w_i g_i / √(Σ w_i²)
struct Tiles {
    vec2 at0, at1, at2;
    vec3 w;
};

vec2 tile_shift(ivec2 vertex) {
    uvec2 v = uvec2(vertex) * uvec2(0x9E3779B9u, 0x85EBCA6Bu);
    uint h = v.x ^ (v.y + (v.x << 6) + (v.x >> 2));
    h ^= h >> 16; h *= 0x7FEB352Du; h ^= h >> 15; h *= 0x846CA68Bu; h ^= h >> 16;
    return vec2(h & 0xFFFFu, h >> 16) / 65536.0;
}

Tiles tiles_at(vec2 st) {
    Tiles t;
#ifdef REPEAT
    t.at0 = t.at1 = t.at2 = st;
    t.w = vec3(1.0, 0.0, 0.0);
#else
    const float EDGES = 1.5;  // of the grid along a tile: longer waves than its edge are lost
    vec2 skewed = mat2(1.0, 0.0, -0.57735027, 1.15470054) * (st * EDGES);
    ivec2 base = ivec2(floor(skewed));
    vec3 f = vec3(fract(skewed), 0.0);
    f.z = 1.0 - f.x - f.y;
    ivec2 a, b, c;
    if (f.z > 0.0) {
        t.w = vec3(f.z, f.y, f.x);
        a = base; b = base + ivec2(0, 1); c = base + ivec2(1, 0);
    } else {
        t.w = vec3(-f.z, 1.0 - f.y, 1.0 - f.x);
        a = base + 1; b = base + ivec2(1, 0); c = base + ivec2(0, 1);
    }
    t.w /= length(t.w);
    t.at0 = st + tile_shift(a);
    t.at1 = st + tile_shift(b);
    t.at2 = st + tile_shift(c);
#endif
    return t;
}

vec3 field_at(Tiles t, int k, vec2 dx, vec2 dy) {
    float layer = float(k);
    vec3 g = t.w.x * (textureGrad(fields, vec3(t.at0, layer), dx, dy).xyz * 2.0 - 1.0);
#ifndef REPEAT
    g += t.w.y * (textureGrad(fields, vec3(t.at1, layer), dx, dy).xyz * 2.0 - 1.0);
    g += t.w.z * (textureGrad(fields, vec3(t.at2, layer), dx, dy).xyz * 2.0 - 1.0);
#endif
    return g * G;
}

#ifdef PATTERN
// u(x) = B⁻¹ (x + D(x)): D is a Gaussian field as well, and blended with the others.
vec2 phase_at(vec2 texel, Tiles t, vec2 dx, vec2 dy) {
    vec2 shift = t.w.x * textureGrad(phase, t.at0, dx, dy).xy;
#ifndef REPEAT
    shift += t.w.y * textureGrad(phase, t.at1, dx, dy).xy;
    shift += t.w.z * textureGrad(phase, t.at2, dx, dy).xy;
#endif
    vec2 x = texel.yx - 0.5;  // (row, column); pixels are whole numbers there
    return vec2(dot(latticeInverse.xy, x), dot(latticeInverse.zw, x)) + shift;
}
#endif

// ---------------------------------------------------------------- appearance

// srgb_decode, and ½ of its second derivative.
vec3 decode(vec3 code) {
    return mix(code / 12.92, pow((code + 0.055) / 1.055, vec3(2.4)), step(0.04045, code));
}
vec3 half_curvature(vec3 code) {
    return step(0.04045, code) * (0.5 * 2.4 * 1.4 / (1.055 * 1.055)) * pow((max(code, 0.0) + 0.055) / 1.055, vec3(0.4));
}

// The place that a pixel sees, in the fields, and in the cell of a pattern.
struct Place {
    Tiles tiles;
    vec2 dx, dy;    // of the fields' coordinates
    float level;
    vec2 u;
    vec2 udx, udy;
};
Place place;

// A curve of each plane at places x from 0 to 1, where a texture has them as nodes of its rows.
vec3 curve_at(sampler2D curve, vec3 x, float row) {
    x = (clamp(x, 0.0, 1.0) * (G_NODES - 1.0) + 0.5) / G_NODES;
    return vec3(texture(curve, vec2(x.x, row)).x, texture(curve, vec2(x.y, row)).y, texture(curve, vec2(x.z, row)).z);
}

// v = tone⁻¹(Tᵀ X + mean), X = q(g), or c(m(u) + s(u) q(g) + Σ l(u) q(g)) of a pattern: invert_spectral,
// apply_periodic_layer.
//
// At mip level m a field is an average over a pixel. The curves of that level are already
// E[q(g + hidden part)]; the tone's curve is taken to second order in the variance that the
// level hides, E[f(x)] ≈ f(x) + ½ f''(x) s². So a distant texture keeps its mean colour.
vec3 texture_at(int k, vec4 hides) {
    int row = k * SUBSPACE_ROWS;
    float level = clamp(place.level, 0.0, float(LEVELS - 1));
    float curve_row = (float(k * LEVELS) + level + 0.5) / float(SUBSPACES * LEVELS);
    vec3 q = curve_at(curves, field_at(place.tiles, k, place.dx, place.dy) * (0.5 / G) + 0.5, curve_row);
#ifdef PATTERN
    vec2 at = place.u.yx + CELL_HALF_TEXEL;
    vec3 m = textureGrad(cells, vec3(at, float(3 * k)), place.udx.yx, place.udy.yx).xyz;
    vec3 s = textureGrad(cells, vec3(at, float(3 * k + 1)), place.udx.yx, place.udy.yx).xyz;
    vec3 l = textureGrad(cells, vec3(at, float(3 * k + 2)), place.udx.yx, place.udy.yx).xyz;
    vec3 mixed = vec3(0.0, l.x * q.x, l.y * q.x + l.z * q.y);
    q = curve_at(toneCurves, (m + s * q + mixed - subspaces[row + ROW_LOW].xyz) * subspaces[row + ROW_SCALE].xyz, curve_row);
#endif
    vec4 mean = subspaces[row + ROW_MEAN];
    vec3 v = max(mean.xyz + q.x * subspaces[row].xyz + q.y * subspaces[row + 1].xyz + q.z * subspaces[row + 2].xyz, 0.0);
    return mean.w == 0.0 ? v : decode(v) + half_curvature(v) * hides.xyz;
}

// ---------------------------------------------------------------- surface

float height_at(vec2 texel, float level) {
    return relief * textureLod(surface, texel / surfaceSize, level).w;
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

vec3 shading_moments(vec3 light) {
    vec2 at = (light.xy / (1.0 + max(light.z, 0.0)) * 0.5 + 0.5) * float(MOMENT_SIDE - 1) + 0.5;
    return max(texture(moments, at / float(MOMENT_SIDE)).xyz, 1e-4);
}

// ---------------------------------------------------------------- interpolation

// The weights of the pairs of the nearest three lights and views, and their subspaces: row i is
// of light i.
struct Pairs {
    vec3 w0, w1, w2;
    ivec3 k0, k1, k2;
    vec4 e;          // encoded mean colour and contrast
    float fade;
};

#ifdef MEASURED
// Adds the pairs of one light. \param z  its height and the cube root of it, weighted
void add_pairs(int light, float w, Corners view, out vec3 weights, out ivec3 k, inout vec4 e, inout vec2 z) {
    weights = w * view.w;
    z += w * uintBitsToFloat(in_list(lightCells, LIGHT_HEIGHTS + light).xy);
    for (int j = 0; j < 3; ++j) {
        uvec4 pair = in_list(pairs, light * VIEWS + (j == 0 ? view.number.x : j == 1 ? view.number.y : view.number.z));
        int subspace = int(pair.w & 0xFFu);
        float weight = j == 0 ? weights.x : j == 1 ? weights.y : weights.z;
        if (j == 0) k.x = subspace;
        else if (j == 1) k.y = subspace;
        else k.z = subspace;
        e += weight * vec4(uintBitsToFloat(pair.xyz), unpackHalf2x16(pair.w >> 16).x);
    }
}
#endif

// Steps 1 to 3 of DirectionalInterpolation::at.
Pairs interpolate(Corners view, vec3 light) {
    Pairs p;
    p.e = vec4(0.0);
    p.fade = light.z;
    p.w0 = vec3(1.0, 0.0, 0.0);
    p.w1 = p.w2 = vec3(0.0);
    p.k0 = p.k1 = p.k2 = ivec3(0);
#ifdef MEASURED
    Corners l = corners_of(lightCells, light);
    vec2 z = vec2(0.0);
    add_pairs(l.number.x, l.w.x, view, p.w0, p.k0, p.e, z);
    add_pairs(l.number.y, l.w.y, view, p.w1, p.k1, p.e, z);
    add_pairs(l.number.z, l.w.z, view, p.w2, p.k2, p.e, z);
#ifdef COSINE_INCLUDED
#ifdef REFLECTANCE
    p.fade = min(4.0, light.z / max(z.y * z.y * z.y, 1e-3));
#else
    p.fade = min(4.0, light.z / max(z.x, 1e-3));
#endif
#endif
#endif
    return p;
}

// The subspace of a pair that has weight, or -1.
int next_subspace(Pairs p) {
    if (p.w0.x > 0.0) return p.k0.x;
    if (p.w0.y > 0.0) return p.k0.y;
    if (p.w0.z > 0.0) return p.k0.z;
    if (p.w1.x > 0.0) return p.k1.x;
    if (p.w1.y > 0.0) return p.k1.y;
    if (p.w1.z > 0.0) return p.k1.z;
    if (p.w2.x > 0.0) return p.k2.x;
    if (p.w2.y > 0.0) return p.k2.y;
    if (p.w2.z > 0.0) return p.k2.z;
    return -1;
}

// The weight of all pairs of subspace k, which is then taken from them.
float take_weight(inout Pairs p, int k) {
    vec3 of0 = vec3(equal(p.k0, ivec3(k)));
    vec3 of1 = vec3(equal(p.k1, ivec3(k)));
    vec3 of2 = vec3(equal(p.k2, ivec3(k)));
    float w = dot(of0, p.w0) + dot(of1, p.w1) + dot(of2, p.w2);
    p.w0 -= of0 * p.w0;
    p.w1 -= of1 * p.w1;
    p.w2 -= of2 * p.w2;
    return w;
}

// The value of the place for one light: steps 4 to 6, max(0, offset + gain (x s)^power).
// A mip level that keeps a share of the variance keeps as much of what the power takes off the mean.
// \param s  shading of mean 1;  C_s, h_s  ln(E s² / (E s)²) and -8 ln(E √s / √E s) over the surface
vec3 value_for(Pairs p, float s, float C_s, float h_s) {
    vec3 x = vec3(0.0);
    vec3 mean = vec3(0.0);
    vec4 F = vec4(0.0);
    vec4 shape = vec4(0.0);
    float kept = 0.0;
    for (int k = next_subspace(p); k >= 0; k = next_subspace(p)) {
        float w = take_weight(p, k);
        vec2 at = vec2((float(k) + 0.5) / float(SUBSPACES), (clamp(place.level, 0.0, float(LEVELS - 1)) + 0.5) / float(LEVELS));
        vec4 hides = texture(hidden, at);
        x += w * texture_at(k, hides);
#ifdef REFLECTANCE
        vec3 own = subspaces[k * SUBSPACE_ROWS + ROW_TEXTURE].xyz;
        mean += w * own;
        F += w * subspaces[k * SUBSPACE_ROWS + ROW_COVARIANCE];
        shape += w * dot(LUMINANCE, own) * subspaces[k * SUBSPACE_ROWS + ROW_SHAPE];
        kept += w * hides.w;
#endif
    }
    x *= s;
#ifdef REFLECTANCE
    vec3 e = max(p.e.xyz, 0.0);
    vec3 target = p.fade * e * e * e;
    float Y = max(dot(LUMINANCE, mean), 1e-6);
    mean = max(mean, 1e-6);
    shape /= Y;
    float C = log(1.0 + dot(F, F) / (Y * Y));
    float h = C + C * C * shape.w;
    C = max(C + C_s, 1e-6);
    float H = clamp(h + h_s, 0.5 * C, 2.83 * C);
    float q = log2(4.0 * C / H);
    float wanted = max(0.0, p.e.w);
    float power = clamp(pow(log(1.0 + wanted * wanted) / C, 1.0 / q), 0.5, 1.0);
    float amplify = min(3.0, wanted / sqrt(max(exp(C * pow(power, q)) - 1.0, 1e-6)));
    vec3 c = (shape.xyz * h + h_s) * (1.0 + (C / H - 1.0) * (power - 0.5) / 1.5);
    vec3 E = exp(-0.5 * power * (1.0 - power) * c * kept);
    return max(vec3(0.0), target * (1.0 - amplify + amplify * pow(max(x, 0.0) / mean, vec3(power)) / E));
#else
    return p.fade * x;
#endif
}

// The colours of the subspaces, by their weights.
vec3 palette_of(Pairs p) {
    vec3 sum = vec3(0.0);
    for (int k = next_subspace(p); k >= 0; k = next_subspace(p)) sum += take_weight(p, k) * palette[k];
    return sum;
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
    // As anisotropic filtering chooses it: by the shorter axis, up to ANISOTROPY to 1.
    vec2 axes = vec2(dot(dx, dx), dot(dy, dy));
    place.level = 0.5 * log2(max(max(min(axes.x, axes.y), max(axes.x, axes.y) / (ANISOTROPY * ANISOTROPY)), 1e-8));

    vec3 normal = vec3(0.0, 0.0, 1.0);
    vec3 hit = vec3(texel, 0.0);
    bool rough = false;
#ifdef SURFACE
    rough = relief > 0.0 && viewMode != VIEW_SMOOTH && viewMode != VIEW_INDEX;
    if (rough) {
        if (marched) hit = relief_hit(texel, view, place.level);
        vec3 n = textureLod(surface, hit.xy / surfaceSize, place.level).xyz;
        float size = dot(n, n);
        normal = vec3(relief * n.xy, n.z);
        normal *= sqrt(size / dot(normal, normal));
    }
#endif

    Corners view_corners = Corners(ivec3(0), vec3(1.0, 0.0, 0.0));
#ifdef MEASURED
    view_corners = corners_of(viewCells, view);
#endif

    vec2 st = hit.xy / fieldSize;
    place.tiles = tiles_at(st);
    place.dx = dx / fieldSize;
    place.dy = dy / fieldSize;
#ifdef PATTERN
    place.u = phase_at(hit.xy, place.tiles, place.dx, place.dy);
    place.udx = vec2(dot(latticeInverse.xy, dx.yx), dot(latticeInverse.zw, dx.yx));
    place.udy = vec2(dot(latticeInverse.xy, dy.yx), dot(latticeInverse.zw, dy.yx));
#endif

    // Light from everywhere is taken to come from the normal, which is exact for a matt surface.
    vec3 ambient = ambientLightColor;
#if NUM_HEMI_LIGHTS > 0
    vec3 bent = normalize(frame * normal);
    for (int i = 0; i < NUM_HEMI_LIGHTS; ++i)
        ambient += getHemisphereLightIrradiance(hemisphereLights[i], bent);
#endif
    vec3 radiance = vec3(0.0);
    int first = ambient == vec3(0.0) ? 0 : -1;
    for (int i = first; i < NUM_DIR_LIGHTS; ++i) {
        vec3 irradiance = ambient;
        vec3 light = vec3(0.0, 0.0, 1.0);
#if NUM_DIR_LIGHTS > 0
        if (i >= 0) {
            irradiance = directionalLights[i].color;
            light = directionalLights[i].direction * frame;
        }
#endif
        if (light.z <= 0.0) continue;
        float s = 1.0;
        float C_s = 0.0;
        float h_s = 0.0;
        float clay = light.z;
#ifdef SURFACE
        if (rough && i >= 0) {
            float shadow = marched ? self_shadow(hit, light, place.level) : 1.0;
            clay = lit(normal, light, place.level) * shadow;
#ifdef DELIT
            vec3 mean = shading_moments(light);
            s = lit(normal, light, place.level) / mean.x;
            C_s = log(max(1.0, mean.y / (mean.x * mean.x)));
            h_s = max(0.0, -8.0 * log(mean.z / sqrt(mean.x)));
#endif
            s *= shadow;
        }
#endif
        if (viewMode == VIEW_RELIEF) {
            radiance += 0.5 * irradiance * clay;
            continue;
        }
        Pairs p = interpolate(view_corners, light);
        if (viewMode == VIEW_INDEX) {
            radiance = palette_of(p);
            continue;
        }
        radiance += irradiance * value_for(p, s, C_s, h_s);
    }
    if (viewMode == VIEW_INDEX) return radiance;
    const float RECIPROCAL_PI_ = 0.3183098861837907;
    return exposure * (viewMode == VIEW_RELIEF ? vec3(1.0) : tint) * radiance * RECIPROCAL_PI_;
}
