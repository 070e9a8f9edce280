// SPDX-License-Identifier: Apache-2.0
declare module '*.glsl?raw' {
  const source: string;
  export default source;
}
declare module '*?worker&inline' {
  const Constructor: new () => Worker;
  export default Constructor;
}
