"""REBOUND: IAS15 with its precision parameter, WHFast with a fixed step. For bodies under gravity only."""

import rebound


class Runner:
    def __init__(self, request):
        raise NotImplementedError


def build(request):
    return Runner(request)
