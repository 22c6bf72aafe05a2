// Draws segments as strips some pixels wide, with soft edges, fainter towards the back.

const VERTEX = `#version 300 es
in vec3 start;
in vec3 end;
uniform mat4 matrix;
uniform vec2 port;
uniform float width;
out float across;
out float depth;
void main() {
  vec4 a = matrix * vec4(start, 1.0);
  vec4 b = matrix * vec4(end, 1.0);
  float side = float(gl_VertexID & 1) * 2.0 - 1.0;
  vec2 along = (b.xy / b.w - a.xy / a.w) * port;
  vec2 normal = length(along) > 1e-6 ? normalize(vec2(-along.y, along.x)) : vec2(0.0, 1.0);
  vec4 corner = gl_VertexID < 2 ? a : b;
  float reach = 0.5 * width + 1.0;
  across = side * reach;
  depth = corner.z / corner.w * 0.5 + 0.5;
  gl_Position = corner + vec4(normal * side * reach * 2.0 / port * corner.w, 0.0, 0.0);
}`;

const FRAGMENT = `#version 300 es
precision highp float;
in float across;
in float depth;
uniform vec3 colour;
uniform float width;
out vec4 drawn;
void main() {
  float edge = clamp(0.5 * width + 0.5 - abs(across), 0.0, 1.0);
  float alpha = edge * mix(1.0, 0.16, smoothstep(0.25, 0.85, depth));
  drawn = vec4(colour * alpha, alpha);
}`;

const CORNERS = 4;
const SEGMENT_BYTES = 24;

/// Throws Error with the driver's words.
function compile(gl: WebGL2RenderingContext, type: number, source: string): WebGLShader {
  const shader = gl.createShader(type)!;
  gl.shaderSource(shader, source);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost())
    throw new Error(gl.getShaderInfoLog(shader) ?? 'a shader does not compile');
  return shader;
}

function link(gl: WebGL2RenderingContext): WebGLProgram {
  const program = gl.createProgram();
  gl.attachShader(program, compile(gl, gl.VERTEX_SHADER, VERTEX));
  gl.attachShader(program, compile(gl, gl.FRAGMENT_SHADER, FRAGMENT));
  gl.bindAttribLocation(program, 0, 'start');
  gl.bindAttribLocation(program, 1, 'end');
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost())
    throw new Error(gl.getProgramInfoLog(program) ?? 'the shaders do not link');
  return program;
}

/// Segments in a buffer of the context that made them.
export interface Lines {
  array: WebGLVertexArrayObject;
  count: number;
}

export class LineShader {
  private readonly program: WebGLProgram;
  private readonly uniforms: Record<'matrix' | 'port' | 'width' | 'colour', WebGLUniformLocation | null>;

  constructor(private readonly gl: WebGL2RenderingContext) {
    this.program = link(gl);
    const find = (name: string): WebGLUniformLocation | null => gl.getUniformLocation(this.program, name);
    this.uniforms = { matrix: find('matrix'), port: find('port'), width: find('width'), colour: find('colour') };
  }

  /// `ends`: six numbers a segment.
  upload(ends: Float32Array): Lines {
    const { gl } = this;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, ends, gl.STATIC_DRAW);
    for (const place of [0, 1]) {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, 3, gl.FLOAT, false, SEGMENT_BYTES, 12 * place);
      gl.vertexAttribDivisor(place, 1);
    }
    return { array, count: ends.length / 6 };
  }

  /// Before all lines of a frame.
  begin(width: number): void {
    const { gl } = this;
    gl.useProgram(this.program);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.uniform1f(this.uniforms.width, width);
  }

  draw(lines: Lines, matrix: readonly number[], size: readonly [number, number], colour: readonly [number, number, number]): void {
    const { gl } = this;
    gl.uniformMatrix4fv(this.uniforms.matrix, false, matrix);
    gl.uniform2f(this.uniforms.port, ...size);
    gl.uniform3f(this.uniforms.colour, ...colour);
    gl.bindVertexArray(lines.array);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, CORNERS, lines.count);
  }
}
