// The library compiles the function bodies of this header here.
#include <pliant/shape/superellipse-inl.h>
