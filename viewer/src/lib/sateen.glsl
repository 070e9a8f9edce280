// SPDX-License-Identifier: Apache-2.0
// The evaluation of a material on the GPU (WebGL 2). Names are those of the C++: g, q, T, mean,
// tone (synthesis/appearance.cpp), index, subspace, view, light (material/material.hpp).
// Theory, and how many texels a pixel reads: docs/theory/viewer_shader.md.
//
// A pixel's colour is
//
//     Σ_lights E  Σ_{i,j ∈ 3 × 3} w_i^view w_j^light  a_ij  v_k(x),   k = index(i, j)
//
// with barycentric weights w in the triangles of measured directions [CAR2 §IV], the reflectance
// a_ij of each pair, and the texture v_k of its subspace at the place x. It is linear in v_k:
// weights are summed for each subspace first, and each texture is read once for all lights.

precision highp float;
precision highp int;
precision highp sampler2DArray;
precision highp usampler2D;

uniform sampler2DArray fields;  // layer k: g of every plane, toroidal, (g + G) / 2G
uniform sampler2D curves;       // rows (k, level): q(g) of every plane
uniform sampler2D planes;       // column k: rows of T, then mean, then s² of each level
uniform usampler2D viewCells;   // triangulated views: core/direction_mesh.hpp
uniform usampler2D lightCells;
uniform sampler2D pairs;        // (a_ij, k), lights outermost, LIST_COLS a row
uniform sampler2D surface;      // slopes p = ∂z/∂x, q = ∂z/∂y, height z in texels, p² + q²
uniform vec2 surfaceSize;       // of its torus, in texels
uniform vec2 fieldSize;         // of the torus of fields, in texels
uniform vec2 texelsPerUv;
uniform vec2 heightRange;       // smallest and largest height, in texels
uniform float relief;           // scale of heights; 0 switches relief off
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

// ---------------------------------------------------------------- directions

struct Corners {
    ivec3 number;
    vec3 w;
};

// DirectionMesh::interpolate: the square of the stereographic map (x, y) / (1 + z) that d is in
// names a cell, from which a walk leads across the border that d is furthest beyond. The weights
// are s_k = row_k · d, of sum 1; past the rim (in a sector) the third counts as 0.
Corners corners_of(usampler2D cells, vec3 d) {
    vec2 at = clamp((d.xy / (1.0 + d.z) * 0.5 + 0.5) * float(START_SIDE), 0.0, float(START_SIDE - 1));
    int square = int(at.y) * START_SIDE + int(at.x);
    uvec4 four = texelFetch(cells, ivec2((square >> 2) % LIST_COLS, (square >> 2) / LIST_COLS), 0);
    int cell = int(four[square & 3]);
    uvec4 a, b, c;
    vec3 s;
    for (int walk = 0; walk < 6; ++walk) {
        int first = START_SIDE * START_SIDE / 4 + 3 * cell;
        a = texelFetch(cells, ivec2(first % LIST_COLS, first / LIST_COLS), 0);
        b = texelFetch(cells, ivec2((first + 1) % LIST_COLS, (first + 1) / LIST_COLS), 0);
        c = texelFetch(cells, ivec2((first + 2) % LIST_COLS, (first + 2) / LIST_COLS), 0);
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

// ---------------------------------------------------------------- appearance

// srgb_decode, and ½ of its second derivative.
vec3 decode(vec3 code) {
    return mix(code / 12.92, pow((code + 0.055) / 1.055, vec3(2.4)), step(0.04045, code));
}
vec3 half_curvature(vec3 code) {
    return step(0.04045, code) * (0.5 * 2.4 * 1.4 / (1.055 * 1.055)) * pow((max(code, 0.0) + 0.055) / 1.055, vec3(0.4));
}

#ifdef COLOURS
// Finished textures, stored as √(v / 2).
vec3 colour_at(vec2 st, int k, vec2 dx, vec2 dy) {
    vec3 root = textureGrad(fields, vec3(st, float(k)), dx, dy).xyz;
    return 2.0 * root * root;
}
#endif

// v = tone⁻¹(Tᵀ q(g) + mean): invert_spectral.
//
// At mip level m a field is an average over a pixel. The curves of that level are already
// E[q(g + hidden part)]; the tone's curve is taken to second order in the variance s² that the
// level hides, E[f(x)] ≈ f(x) + ½ f''(x) s². So a distant texture keeps its mean colour.
vec3 invert_spectral(vec3 g, int k, float level) {
    vec3 x = (g / G * (G_NODES - 1.0) + G_NODES) * 0.5 / G_NODES;
    float row = (float(k * LEVELS) + clamp(level, 0.0, float(LEVELS - 1)) + 0.5) / float(SUBSPACES * LEVELS);
    vec3 q = vec3(texture(curves, vec2(x.x, row)).x, texture(curves, vec2(x.y, row)).y,
                  texture(curves, vec2(x.z, row)).z);
    vec4 mean = texelFetch(planes, ivec2(k, 3), 0);
    vec3 v = mean.xyz + q.x * texelFetch(planes, ivec2(k, 0), 0).xyz +
             q.y * texelFetch(planes, ivec2(k, 1), 0).xyz + q.z * texelFetch(planes, ivec2(k, 2), 0).xyz;
    v = max(v, 0.0);
    if (mean.w == 0.0) return v;
    int m = int(clamp(level + 0.5, 0.0, float(LEVELS - 1)));
    return decode(v) + half_curvature(v) * texelFetch(planes, ivec2(k, 4 + m), 0).xyz;
}

// ---------------------------------------------------------------- surface

float height_at(vec2 texel, vec2 dx, vec2 dy) {
    return relief * textureGrad(surface, texel / surfaceSize, dx / surfaceSize, dy / surfaceSize).z;
}

// Where the ray towards the eye leaves the surface: a linear search and a secant step.
// `texel` is where it meets the plane of height 0. [CAR2 §III: parallax by the range map]
vec3 relief_hit(vec2 texel, vec3 view, vec2 dx, vec2 dy) {
    float top = relief * heightRange.y;
    float bottom = relief * heightRange.x;
    vec2 slope = vec2(view.x, -view.y) / max(view.z, 0.15);
    float step_size = (top - bottom) / float(RELIEF_STEPS);
    float z = top;
    float above = z - height_at(texel + slope * z, dx, dy);
    for (int i = 0; i < RELIEF_STEPS && above > 0.0; ++i) {
        float next = z - step_size;
        float below = next - height_at(texel + slope * next, dx, dy);
        if (below <= 0.0) {
            z = mix(z, next, above / max(above - below, 1e-6));
            break;
        }
        z = next;
        above = below;
    }
    return vec3(texel + slope * z, z);
}

// 1 in light, 0 where the surface hides the light, soft by how far.
float self_shadow(vec3 hit, vec3 light, vec2 dx, vec2 dy) {
    float rise = relief * heightRange.y - hit.z;
    vec2 slope = vec2(light.x, -light.y) / max(light.z, 0.1);
    float hidden = 0.0;
    for (int i = 1; i <= SHADOW_STEPS; ++i) {
        float z = hit.z + rise * (float(i) / float(SHADOW_STEPS));
        float over = height_at(hit.xy + slope * (z - hit.z), dx, dy) - z;
        hidden = max(hidden, over / (0.08 * rise + 0.05) * (1.0 - float(i - 1) / float(SHADOW_STEPS)));
    }
    return 1.0 - clamp(hidden, 0.0, 1.0);
}

// ---------------------------------------------------------------- shading

// Sums the weights of all nine pairs of one light onto their subspaces.
void add_light(Corners view, vec3 light, vec3 irradiance, inout vec3 weight[SUBSPACES]) {
#ifdef MEASURED
    Corners l = corners_of(lightCells, light);
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) {
            float w = view.w[i] * l.w[j];
            if (w < 1e-3) continue;
            int pair = l.number[j] * VIEWS + view.number[i];
            vec4 a_k = texelFetch(pairs, ivec2(pair % LIST_COLS, pair / LIST_COLS), 0);
            weight[int(a_k.w)] += w * a_k.xyz * irradiance;
        }
#else
    weight[0] += irradiance;
#endif
}

// The light that a texture's value does not hold already: the cosine where the measurement
// excludes it, and what lies below the lowest measured light.
float cosine_factor(vec3 light) {
#ifdef COSINE_INCLUDED
    return min(1.0, light.z / LOWEST_LIGHT);
#else
    return light.z;
#endif
}

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
    view = normalize(vec3(view.xy, max(view.z, 0.02)));

    // Rows of textures run downwards.
    vec2 texel = vec2(vUv.x, -vUv.y) * texelsPerUv;
    vec2 dx = dFdx(texel);
    vec2 dy = dFdy(texel);
    // As anisotropic filtering chooses it: by the shorter axis, up to 8 to 1.
    vec2 axes = vec2(dot(dx, dx), dot(dy, dy));
    float level = 0.5 * log2(max(max(min(axes.x, axes.y), max(axes.x, axes.y) / (ANISOTROPY * ANISOTROPY)), 1e-8));

    vec3 normal = vec3(0.0, 0.0, 1.0);
    vec3 hit = vec3(texel, 0.0);
#ifdef SURFACE
    bool rough = relief > 0.0 && viewMode != VIEW_SMOOTH && viewMode != VIEW_INDEX;
    if (rough) {
        hit = relief_hit(texel, view, dx, dy);
        vec2 slopes = relief * textureGrad(surface, hit.xy / surfaceSize, dx / surfaceSize, dy / surfaceSize).xy;
        normal = normalize(vec3(-slopes, 1.0));
    }
#endif

    Corners view_corners = Corners(ivec3(0), vec3(1.0, 0.0, 0.0));
#ifdef MEASURED
    view_corners = corners_of(viewCells, view);
#endif
    vec3 weight[SUBSPACES];
    for (int k = 0; k < SUBSPACES; ++k) weight[k] = vec3(0.0);
    vec3 clay = vec3(0.0);

#if NUM_DIR_LIGHTS > 0
    for (int i = 0; i < NUM_DIR_LIGHTS; ++i) {
        vec3 light = directionalLights[i].direction * frame;
        if (light.z <= 0.0) continue;
        vec3 irradiance = directionalLights[i].color;
        float shade = 1.0;
#ifdef SURFACE
        if (rough) {
            shade = clamp(dot(normal, light) / max(light.z, 0.2), 0.0, 2.0);
            shade *= self_shadow(hit, light, dx, dy);
        }
#endif
        clay += irradiance * shade * light.z;
        add_light(view_corners, light, irradiance * shade * cosine_factor(light), weight);
    }
#endif
    // Light from everywhere is taken to come from the normal, which is exact for a matt surface.
    vec3 ambient = ambientLightColor;
#if NUM_HEMI_LIGHTS > 0
    vec3 bent = normalize(frame * normal);
    for (int i = 0; i < NUM_HEMI_LIGHTS; ++i)
        ambient += getHemisphereLightIrradiance(hemisphereLights[i], bent);
#endif
    if (dot(ambient, ambient) > 0.0) add_light(view_corners, normal, ambient, weight);
    clay += ambient;

    const float RECIPROCAL_PI_ = 0.3183098861837907;
    if (viewMode == VIEW_RELIEF) return exposure * clay * 0.5 * RECIPROCAL_PI_;

    vec2 st = hit.xy / fieldSize;
    Tiles tiles = tiles_at(st);
    dx /= fieldSize;
    dy /= fieldSize;
    vec3 radiance = vec3(0.0);
    for (int k = 0; k < SUBSPACES; ++k) {
        if (dot(weight[k], vec3(1.0)) < 1e-4) continue;
        vec3 v = palette[k];
        if (viewMode != VIEW_INDEX) {
#ifdef COLOURS
            v = colour_at(st, k, dx, dy);
#else
            v = invert_spectral(field_at(tiles, k, dx, dy), k, level);
#endif
        }
        radiance += weight[k] * v;
    }
    if (viewMode == VIEW_INDEX) {
        vec3 sum = vec3(0.0);
        for (int k = 0; k < SUBSPACES; ++k) sum += weight[k];
        return radiance / max(sum, 1e-4);
    }
    return exposure * tint * radiance * RECIPROCAL_PI_;
}
