// The library's instance of the function bodies in <pliant/method/implicit/implicit_nodes-inl.h>.
#include <pliant/method/implicit/implicit_nodes-inl.h>
