import stiction as st
try: print(st.Motor(1.1e-5, friction=st.FrictionModel("rigid_perfectly_plastic")).simulate_segments([.0017, .0017], [-.1, -.7], load=[3.2, -1e304]).position)
except BaseException as e: print(type(e),e)
