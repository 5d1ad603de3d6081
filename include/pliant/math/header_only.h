// The macro PLIANT_INLINE marks the function bodies in the headers *-inl.h; foo.h declares the functions. The
// library compiles each body once, in src. A program that extends pliant, or that wants the compiler to
// inline these functions, defines PLIANT_HEADER_ONLY and includes the -inl.h header: its functions are then
// inline.
#pragma once

#ifdef PLIANT_HEADER_ONLY
#define PLIANT_INLINE inline
#else
#define PLIANT_INLINE
#endif
