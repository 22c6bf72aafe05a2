// SPDX-License-Identifier: MIT
import { describe, expect, it } from 'vitest';
import { ShaderChunk } from 'three';
import { leanShader } from '../../lean/glsl.js';

const KNOWN = { absent: /^(?:FOG|SKIN)$/, zeros: /^SPOTS$/ };
const lean = (...lines: string[]): string[] => leanShader(lines.join('\n'), KNOWN).split('\n');

describe('leanShader', () => {
  it('leaves out comments, indents and blanks', () => {
    expect(lean('/* a', 'b */', '  float a = b * ( c + d ); // e', '', '\tvec2 f [ 2 ];')).toEqual(['float a=b*(c + d);', 'vec2 f[2];']);
  });

  it('keeps signs apart', () => {
    expect(lean('a = b - - c + + d;')).toEqual(['a=b - - c + + d;']);
  });

  it('leaves out what is never drawn, with its condition', () => {
    expect(lean('#ifdef FOG', 'a', '#else', 'b', '#endif', 'c')).toEqual(['b', 'c']);
    expect(lean('#ifndef FOG', 'a', '#else', 'b', '#endif')).toEqual(['a']);
    expect(lean('#if SPOTS > 0', 'a', '#endif', 'b')).toEqual(['b']);
    expect(lean('#if defined( FOG ) && defined( MAP )', 'a', '#endif', 'b')).toEqual(['b']);
  });

  it('keeps what may be drawn', () => {
    const texts = ['#ifdef MAP', 'a', '#endif'];
    expect(lean(...texts)).toEqual(texts);
    expect(lean('#if defined( MAP ) || SPOTS > 0', 'a', '#endif')).toEqual(['#if defined( MAP ) || SPOTS > 0', 'a', '#endif']);
    expect(lean('#if LAMPS > 0 || defined( FOG ) && ( defined( MAP ) || SPOTS > 0 )', 'a', '#endif')).toHaveLength(3);
  });

  it('makes the first possible branch the first one', () => {
    expect(lean('#ifdef FOG', 'a', '#elif defined( MAP )', 'b', '#else', 'c', '#endif')).toEqual(['#if defined( MAP )', 'b', '#else', 'c', '#endif']);
    expect(lean('#ifdef MAP', 'a', '#elif defined( FOG )', 'b', '#else', 'c', '#endif')).toEqual(['#ifdef MAP', 'a', '#else', 'c', '#endif']);
    expect(lean('#ifdef MAP', 'a', '#elif ! defined( FOG )', 'b', '#else', 'c', '#endif')).toEqual(['#ifdef MAP', 'a', '#else', 'b', '#endif']);
  });

  it('looks into branches that stay, and not into those that do not', () => {
    expect(lean('#ifdef MAP', '#ifdef FOG', 'a', '#else', 'b', '#endif', '#endif')).toEqual(['#ifdef MAP', 'b', '#endif']);
    expect(lean('#ifdef FOG', '#ifdef MAP', 'a', '#else', 'b', '#endif', '#endif', 'c')).toEqual(['c']);
  });

  it('keeps directives and includes as they are', () => {
    const texts = ['#include <common>', '#define A( x ) ( x )', '#pragma unroll_loop_start'];
    expect(lean(...texts)).toEqual(texts);
  });

  it('refuses a choice without its end', () => {
    expect(() => lean('#ifdef MAP', 'a')).toThrow('no #endif');
    expect(() => lean('a', '#endif')).toThrow('no #if');
  });

  it('takes all of three, and leaves it as it is where nothing is known', () => {
    const nothing = { absent: /^$/, zeros: /^$/ };
    const directives = (text: string): number => text.split('\n').filter((line) => /^\s*#\s*(?:if|el|endif)/.test(line)).length;
    for (const [name, text] of Object.entries(ShaderChunk)) expect(directives(leanShader(text, nothing)), name).toBe(directives(text));
  });
});
