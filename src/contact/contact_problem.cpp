// The library's instance of the function bodies in <pliant/contact/contact_problem-inl.h>.
#include <pliant/contact/contact_problem-inl.h>
